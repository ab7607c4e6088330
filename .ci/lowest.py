"""Print the lowest versions that pyproject.toml allows, as constraints for pip."""

import re
import tomllib
from pathlib import Path

text = Path(__file__).parents[1].joinpath("pyproject.toml").read_text(encoding="utf-8")
project = tomllib.loads(text)["project"]
for requirements in [project["dependencies"], *project["optional-dependencies"].values()]:
    for name, lowest in re.findall(r"^([\w.-]+)>=([\w.]+)$", "\n".join(requirements), re.MULTILINE):
        print(f"{name}=={lowest}")
