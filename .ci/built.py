"""Build what is released, check what is in it, and try the wheel: ``python .ci/built.py FOLDER``.

The sdist and, of it, the wheel are built into FOLDER. The wheel holds every file of the package and
the licences, and no tests. The newest Python of this machine gets it into an environment of its
own, where the program and a user's script run away from the checkout, and the types of the script
are checked; `.ci/run` tests the wheel on the lowest one.
"""

import os
import re
import subprocess
import sys
import tarfile
import tempfile
import tomllib
import zipfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads(ROOT.joinpath("pyproject.toml").read_text(encoding="utf-8"))["project"]

USER = ROOT / "tests" / "typed_user.py"
"""A user's script, of which a strict type checker finds nothing to say either."""


def build(folder: Path) -> Path:
    """Return the wheel, after a look into it and the sdist."""
    command = [sys.executable, "-m", "build", "--no-isolation", "--outdir", folder, ROOT]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    (sdist,), (wheel,) = folder.glob("*.tar.gz"), folder.glob("*.whl")
    subprocess.run([sys.executable, "-m", "twine", "check", "--strict", sdist, wheel], check=True)
    tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, check=True, capture_output=True)
    files = set(tracked.stdout.decode().splitlines())
    package = {name for name in files if name.startswith("bridgectl/")}
    held = set(zipfile.ZipFile(wheel).namelist())
    told = {name for name in held if ".dist-info/" in name}
    same("wheel", held - told, package)
    licences = {name.partition("/licenses/")[2] for name in told} - {""}
    same("licences of the wheel", licences, set(PROJECT["license-files"]))
    with tarfile.open(sdist) as archive:
        inside = {name.partition("/")[2] for name in archive.getnames()}
    same("sdist", inside - {"PKG-INFO"}, files)
    return wheel


def same(what: str, found: set[str], wanted: set[str]) -> None:
    """Complain of files that are too many or too few."""
    if found != wanted:
        raise SystemExit(f"{what}: lacks {wanted - found or ''}, should not have {found - wanted}")
    print(f"{what}: {len(found)} files")


def newest_python() -> str:
    """Return the newest Python that runs, of those on the path and those that pyenv has built."""
    folders = [Path(folder) for folder in os.environ["PATH"].split(os.pathsep)]
    folders += Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")).glob("versions/*/bin")
    found = {sys.version_info[:2]: sys.executable}
    for path in (path for folder in folders for path in folder.glob("python3.*")):
        if name := re.fullmatch(r"python3\.(\d+)", path.name):
            works = subprocess.run([path, "-c", ""], capture_output=True).returncode == 0
            if works and (version := (3, int(name[1]))) not in found:
                found[version] = str(path)
    lowest = tuple(map(int, PROJECT["requires-python"].removeprefix(">=").split(".")))
    known = sorted(version for version in found if version >= lowest)
    print("Pythons:", *(".".join(map(str, version)) for version in known))
    return found[known[-1]]


def try_wheel(wheel: Path, python: str, folder: Path) -> None:
    """Install the wheel, and run it where there is no checkout; a warning is an error."""
    subprocess.run([python, "-m", "venv", folder], check=True)
    own = folder / "bin" / "python"
    subprocess.run([own, "-m", "pip", "install", "--quiet", "--no-compile", wheel], check=True)
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    environment["PYTHONWARNINGS"] = "error"
    for command in (
        [folder / "bin" / "bridgectl", "--version"], [own, "-m", "bridgectl", "profile"],
        [own, USER],
    ):  # fmt: skip
        subprocess.run(command, check=True, cwd=folder, env=environment)
    checker = [sys.executable, "-m", "mypy", "--strict", "--config-file=", "--python-executable"]
    subprocess.run([*checker, own, USER], check=True, cwd=folder)


if __name__ == "__main__":
    built = build(Path(sys.argv[1]))
    with tempfile.TemporaryDirectory() as place:
        try_wheel(built, newest_python(), Path(place))
