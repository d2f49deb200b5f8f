"""What holds for every file: small, at home anywhere, packed, linked."""

import ast
import re
import tomllib
from pathlib import Path

import pytest

from tests.architecture.files import ROOMS, ROOT, modules, tracked

LINES_OF_A_MODULE = 400
LINES_OF_A_FUNCTION = 60
MACHINE_PATHS = re.compile(r"(?<![\w.>])/(?:root|home|work|Users|mnt|media)/\w")
REGISTRIES = re.compile(
    r"\b(?:pypi|pythonhosted|npmjs|docker|ghcr|quay|gcr|anaconda|jsdelivr|unpkg)\.(?:org|io|com|net)\b"
)
LINK = re.compile(r"(?<!!)\[[^\]]*\]\(([^)\s]+)\)|!\[[^\]]*\]\(([^)\s]+)\)")
TEXT = {".py", ".md", ".toml", ".yml", ".yaml", ".json", ".lock", ".Dockerfile", ".html", ".js", ""}


def texts() -> list[tuple[Path, str]]:
    return [
        (path.relative_to(ROOT), path.read_text(errors="replace"))
        for path in tracked()
        if path.suffix in TEXT
    ]


def test_no_module_is_too_long() -> None:
    lengths = {str(path.relative_to(ROOT)): path.read_text().count("\n") for path in modules()}
    assert not {name: n for name, n in lengths.items() if n > LINES_OF_A_MODULE}


def test_no_function_is_too_long() -> None:
    long = [
        f"{path.relative_to(ROOT)}:{node.lineno} {node.name}"
        for path in modules()
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        and (node.end_lineno or 0) - node.lineno + 1 > LINES_OF_A_FUNCTION
    ]
    assert not long


@pytest.mark.parametrize("pattern", [MACHINE_PATHS, REGISTRIES], ids=["paths", "registries"])
def test_no_file_names_a_machine_or_a_registry(pattern: re.Pattern[str]) -> None:
    found = [
        f"{path}: {match.group()}"
        for path, text in texts()
        for match in pattern.finditer(text)
        if path.name != Path(__file__).name
    ]
    assert not found


def test_links_between_documents_resolve() -> None:
    broken = [
        f"{path}: {target}"
        for path, text in texts()
        if path.suffix == ".md"
        for target in (first or second for first, second in LINK.findall(text))
        if "://" not in target
        and not target.startswith("#")
        and not (ROOT / path.parent / target.split("#")[0]).exists()
    ]
    assert not broken


def test_files_named_in_documents_and_code_exist() -> None:
    rooms = "|".join([*ROOMS, "scripts", "docker", "tests"])
    named = re.compile(rf"`((?:{rooms})/[\w./-]*\w)`|\b(docs/[\w/-]+\.md)\b")
    missing = [
        f"{path}: {name}"
        for path, text in texts()
        if path.suffix in {".md", ".py"} and path.name != "CHANGELOG.md"
        for name in (first or second for first, second in named.findall(text))
        if "NAME" not in name and not (ROOT / name).exists()
    ]
    assert not missing


@pytest.mark.parametrize("project", [".", "sdk"])
def test_data_files_are_packed(project: str) -> None:
    settings = tomllib.loads((ROOT / project / "pyproject.toml").read_text())["tool"]["setuptools"]
    includes = [name.rstrip("*") for name in settings["packages"]["find"]["include"]]
    packed = {
        path
        for package, patterns in settings.get("package-data", {}).items()
        for pattern in patterns
        for path in (ROOT / project / package.replace(".", "/")).glob(pattern)
    }
    left_out = [
        str(path.relative_to(ROOT))
        for path in tracked()
        for include in includes
        if path.is_relative_to(ROOT / project / include)
        and path.suffix != ".py"
        and path not in packed
    ]
    assert not left_out


def test_every_package_has_its_init() -> None:
    folders = {path.parent for path in modules() if ROOT / "benchmarks" not in path.parents}
    assert not [str(folder) for folder in folders if not (folder / "__init__.py").exists()]


def test_shell_scripts_are_executable_and_explained() -> None:
    scripts = [path for path in tracked() if path.parent == ROOT / "scripts" and not path.suffix]
    for path in [*scripts, ROOT / ".ci/run"]:
        assert path.stat().st_mode & 0o111, f"{path.name} is not executable"
        shebang, comment, *_ = path.read_text().splitlines()
        assert shebang.startswith("#!/bin/"), path.name
        assert comment.startswith("# "), f"{path.name} does not say what it does"
