"""Execute the notebooks in place: the .ipynb files are the sources, with their outputs.

    python notebooks/build.py                       # every notebook
    python notebooks/build.py 01 02_the_crossing    # those whose names start so
    python notebooks/build.py --to FOLDER 01        # write there and leave the stored one alone

Each runs from the top in a clean kernel of this interpreter, in a temporary folder, and is
written only if nothing failed. A warning is an error, text on stderr too; no output may name a
place in memory or an absolute path, and no file may be larger than 700 KB. Pictures are stored
in 256 colours; times and versions of the machine are left out. The answers to its exercises, folded
away in its text, run after its last cell, in one cell each, and must print what they say.
Needs nbclient and ipykernel, which the `test` extra brings. `notebooks/pages` has what the pages
draw and the checks of what they claim.

`tests/test_notebooks.py` runs this and compares what is printed with what is stored: print no
more digits than every machine agrees on, and of a round-off error only that it is below a bound.
"""

from __future__ import annotations

import argparse
import base64
import io
import os
import re
import sys
import tempfile
from pathlib import Path

import nbformat
from jupyter_client.kernelspec import KernelSpecManager
from jupyter_client.manager import AsyncKernelManager
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError
from nbformat import NotebookNode
from PIL import Image

FOLDER = Path(__file__).parent
LARGEST = 700_000
"""Size of a notebook file, at most [bytes]."""

TIMEOUT = 300
"""Time of one cell, at most [s]."""

KERNEL = [
    "--IPKernelApp.exec_lines=__import__('warnings').simplefilter('error')",
    "--IPKernelApp.exec_lines=__import__('warnings').filterwarnings('ignore', module='ipykernel')",
    "--IPKernelApp.log_level=40",
]
"""Options of the kernel: warnings are errors but its own, and it does not talk about itself."""

METADATA = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}
ANSWER = re.compile(r"<details><summary>Answer</summary>\n\n(.*?)</details>", re.DOTALL)
CODE, PRINTED = (
    re.compile(r"```python\n(.*?)```", re.DOTALL),
    re.compile(r"```text\n(.*?)```", re.DOTALL),
)
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
COLOURS = re.compile(r"\x1b\[[0-9;]*m")
OF_THE_MACHINE = re.compile(
    r"\bat 0x[0-9a-f]+|(?<![\w.:/])/(?:home|root|Users|tmp|var|opt|usr|mnt|work)/|\b[A-Z]:\\"
)
"""What belongs to one machine: places in memory and absolute paths."""


class RefusedError(Exception):
    """A notebook that must not be stored, and why."""


def notebooks(names: list[str] | None = None) -> list[Path]:
    """Return the notebooks in reading order: all, or those whose names start with one given."""
    every = sorted(FOLDER.glob("[0-9][0-9]_*.ipynb"))
    if not names:
        return every
    wanted = [Path(name).stem for name in names]
    unknown = [n for n in wanted if not any(path.stem.startswith(n) for path in every)]
    if unknown:
        known = ", ".join(path.stem for path in every)
        raise RefusedError(f"no notebook starts with {', '.join(unknown)}: there are {known}")
    return [path for path in every if path.stem.startswith(tuple(wanted))]


def execute(notebook: NotebookNode) -> NotebookNode:
    """Run a notebook and its answers in a clean kernel, in place, and clean what it stores."""
    solved = answers(notebook)
    page = len(notebook.cells)
    notebook.cells += [
        nbformat.v4.new_code_cell(code, id=f"a{i}") for i, (code, _) in enumerate(solved)
    ]
    run(notebook)
    wrong = [
        line
        for cell, (_, said) in zip(notebook.cells[page:], solved, strict=True)
        for line in differences(said, "\n".join(texts(cell)))
    ]
    del notebook.cells[page:]
    if wrong:
        raise RefusedError("\n".join(f"an answer's {line}" for line in wrong))
    return clean(notebook)


def answers(notebook: NotebookNode) -> list[tuple[str, str]]:
    """Return the code of each folded answer of a notebook, and what the answer says it prints."""
    found = []
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            for answer in ANSWER.findall(cell.source):
                found.append(("".join(CODE.findall(answer)), "".join(PRINTED.findall(answer))))
    return found


def run(notebook: NotebookNode) -> None:
    """Run all cells of a notebook in a clean kernel, in place, and join what each printed."""
    # Without other places to look in, the only kernel is that of this interpreter.
    manager = AsyncKernelManager(kernel_spec_manager=KernelSpecManager(kernel_dirs=[]))
    with tempfile.TemporaryDirectory() as folder:
        client = NotebookClient(
            notebook,
            km=manager,
            kernel_name="python3",
            timeout=TIMEOUT,
            resources={"metadata": {"path": folder}},
            record_timing=False,
            extra_arguments=KERNEL,
        )
        # The bridgectl beside the notebooks, whatever is installed, and their pages.
        path = os.pathsep.join([str(FOLDER.parent), str(FOLDER), os.environ.get("PYTHONPATH", "")])
        client.execute(
            cleanup_kc=True,  # so that processes the kernel has started end with it
            env=os.environ | {"IPYTHONDIR": folder, "PYTHONPATH": path.rstrip(os.pathsep)},
        )
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.outputs = joined(cell.outputs)


def clean(notebook: NotebookNode) -> NotebookNode:
    """Leave out what differs from run to run and from machine to machine."""
    notebook.metadata = nbformat.from_dict(METADATA)
    for cell in notebook.cells:
        cell.metadata = NotebookNode({k: v for k, v in cell.metadata.items() if k == "tags"})
        for output in cell.get("outputs", []):
            if "metadata" in output:
                output.metadata = NotebookNode()
            if "image/png" in output.get("data", {}):
                output.data["image/png"] = smaller(output.data["image/png"])
    return notebook


def joined(outputs: list[NotebookNode]) -> list[NotebookNode]:
    """Join what was printed in a row: it comes in pieces, by chance."""
    kept: list[NotebookNode] = []
    for output in outputs:
        if kept and output.get("name") and output.get("name") == kept[-1].get("name"):
            kept[-1].text += output.text
        else:
            kept.append(output)
    return kept


def smaller(picture: str) -> str:
    """Return a PNG in 256 colours, in base64: a third of its size and no worse to look at."""
    image = Image.open(io.BytesIO(base64.b64decode(picture))).convert("RGB")
    file = io.BytesIO()
    image.quantize(256, dither=Image.Dither.NONE).save(file, "PNG", optimize=True)
    return base64.b64encode(file.getvalue()).decode()


def texts(cell: NotebookNode) -> list[str]:
    """Return what a cell printed and showed, in words: pictures are left out."""
    found = []
    for output in cell.get("outputs", []):
        if output.output_type == "stream":
            found.append(output.text)
        elif output.output_type == "error":
            found.append(f"{output.ename}: {output.evalue}")
        elif "image/png" not in output.data:
            found += [text for kind, text in sorted(output.data.items()) if kind[:4] == "text"]
    return found


def unit(number: str) -> float:
    """One unit of the last digit of a printed number; none of a whole number.

    Whole thousands are counts of which some lie at a limit: 0.2 %.
    """
    mantissa, _, exponent = number.partition("e")
    if mantissa == number and "." not in number:
        return 2e-3 * abs(float(number)) if abs(float(number)) >= 1000 else 0.0
    return 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


def differences(stored: str, printed: str) -> list[str]:
    """Lines that differ by more than one unit in the last digit of a number, or in words."""
    old, new = stored.strip().splitlines(), printed.strip().splitlines()
    if len(old) != len(new):
        return [f"{len(old)} lines stored, {len(new)} printed"]
    return [f"{a!r} is now {b!r}" for a, b in zip(old, new, strict=True) if not same(a, b)]


def same(stored: str, printed: str) -> bool:
    """Tell whether two lines agree but for the last digit of their numbers."""
    # Spaces fill up columns, so that they go with the numbers.
    words = [NUMBER.sub("#", line).replace(" ", "") for line in (stored, printed)]
    numbers = zip(NUMBER.findall(stored), NUMBER.findall(printed), strict=False)
    return words[0] == words[1] and all(
        abs(float(a) - float(b)) <= 1.001 * max(unit(a), unit(b)) for a, b in numbers
    )


def faults(notebook: NotebookNode) -> list[str]:
    """Return what keeps an executed notebook from being stored, in words."""
    found = []
    for number, cell in enumerate(notebook.cells):
        for output in cell.get("outputs", []):
            if output.output_type == "error" or output.get("name") == "stderr":
                found.append(f"cell {number}: {output.get('text', output.get('evalue'))}")
        if cell.cell_type == "code" and cell.source and cell.execution_count is None:
            found.append(f"cell {number} was not run")
        for text in [cell.source, *texts(cell)]:
            for match in OF_THE_MACHINE.finditer(text):
                around = text[max(0, match.start() - 30) : match.end() + 30]
                found.append(f"cell {number} holds what belongs to one machine: {around!r}")
    if len(as_text(notebook).encode()) > LARGEST:
        size = len(as_text(notebook).encode()) / 1000
        found.append(f"{size:.0f} KB, at most {LARGEST / 1000:.0f}: make its pictures smaller")
    return found


def as_text(notebook: NotebookNode) -> str:
    """Return a notebook as its file holds it."""
    return nbformat.writes(notebook).rstrip("\n") + "\n"


def build(path: Path, to: Path | None = None) -> Path:
    """Execute one notebook and write it, in place or into the folder `to`."""
    notebook = nbformat.read(path, as_version=4)
    try:
        execute(notebook)
    except RefusedError as error:
        raise RefusedError(f"{path.name}: {error}") from None
    except CellExecutionError as error:
        raise RefusedError(f"{path.name}: {COLOURS.sub('', str(error))}") from None
    found = faults(notebook)
    if found:
        raise RefusedError("\n".join(f"{path.name}: {fault}" for fault in found))
    target = path if to is None else to / path.name
    target.write_text(as_text(notebook), encoding="utf-8")
    return target


def main(arguments: list[str] | None = None) -> int:
    """Run the command; the exit status is 1 if a notebook was refused."""
    parser = argparse.ArgumentParser(description="Execute notebooks and store their outputs.")
    parser.add_argument("names", nargs="*", help="how the wanted notebooks' names start")
    parser.add_argument("--to", type=Path, help="folder to write to instead of in place")
    options = parser.parse_args(arguments)
    try:
        for path in notebooks(options.names):
            target = build(path, options.to)
            print(f"{path.stem}: {target.stat().st_size / 1000:.0f} KB")
    except RefusedError as refusal:
        print(refusal, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
