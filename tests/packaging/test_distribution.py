"""Wheel and source distribution, built from a clone, installed in fresh environments. Needs a package index.

Run by ``pytest -m exhaustive tests/packaging -n 0``, with the extra ``release`` installed; ``.ci/run`` leaves
out what installs an extra, and all but one of the other versions of Python.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
TRIED = {
    "": "cc.solve('relaxed-equilibrium')",
    "data": "len(cc.solve('relaxed-equilibrium').to_pandas()); cc.solve('relaxed-equilibrium').to_xarray()",
    "sweep": "cc.sweep('relaxed-equilibrium', {'adhesion.work': [4e-4, 5e-4]}, resolution=4, out='s')",
    "dask": """from distributed import Client
with Client(processes=False) as client, client.get_executor() as pool:
    cc.sweep('relaxed-equilibrium', {'adhesion.work': [4e-4, 5e-4]}, resolution=4, executor=pool)""",
    "explore": "cc.explore('relaxed-equilibrium', ['adhesion.work'], values=2).save('page.html')",
    "fit": """cc.write_curve(cc.synthetic(cc.builtin('cycle-v0.1'), noise=0.01), 'a.h5')
assert len(cc.read_curves('a.h5')) == 1""",
    "tamaas": "cc.solve('adhesionless-force', solver='tamaas', resolution=16)",
    "peers": "cc.solve('elastic-press', solver='contact-mechanics', resolution=32)",
    "docs": "[__import__(name) for name in ('sphinx', 'myst_nb', 'furo', 'numpydoc', 'latex2mathml')]",
}
"""Code that needs what an extra brings."""
EXTRAS = ["", *(name for name in PROJECT["optional-dependencies"] if name not in ("dev", "release"))]
NAMED = [name.rpartition(" ")[2] for name in PROJECT["classifiers"] if re.search(r":: 3\.\d+$", name)]
OTHERS = [version for version in NAMED if version != ".".join(map(str, sys.version_info[:2]))]

pytestmark = [
    pytest.mark.exhaustive,
    pytest.mark.skipif(find_spec("build") is None, reason="needs the extra `release`"),
    pytest.mark.skipif(not (ROOT / ".git").exists(), reason="needs the repository, for the version"),
]


def _run(*command, **options):
    own = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    words = [str(word) for word in command]
    ended = subprocess.run(words, capture_output=True, text=True, env=own, **options)
    assert ended.returncode == 0, ended.stdout[-2000:] + ended.stderr[-2000:]
    return ended.stdout


@pytest.fixture(scope="module")
def clone(tmp_path_factory):
    """The last commit, without tags."""
    folder = tmp_path_factory.mktemp("clone") / "crosscontact"
    _run("git", "clone", "--quiet", "--no-tags", ROOT, folder)
    return folder


@pytest.fixture(scope="module")
def built(clone):
    """The folder of sdist and wheel, built from a clone with the tag v7.8.9."""
    _run("git", "-c", "user.name=t", "-c", "user.email=t@t", "tag", "v7.8.9", cwd=clone)
    _run(sys.executable, "-m", "build", "--outdir", clone / "dist", clone)
    return clone / "dist"


@pytest.fixture(scope="module", params=EXTRAS, ids=lambda extra: extra or "no-extra")
def installed(request, built, tmp_path_factory):
    """A fresh environment with the wheel and one extra, and the name of the extra."""
    folder = tmp_path_factory.mktemp("environment")
    _run(sys.executable, "-m", "venv", folder)
    (wheel,) = built.glob("*.whl")
    extra = f"[{request.param}]" if request.param else ""
    pip = folder / "bin" / "pip", "install", "--quiet", "--no-compile"  # little of it is imported
    _run(*pip, f"crosscontact{extra} @ {wheel.as_uri()}")
    yield folder, request.param
    shutil.rmtree(folder)


def test_a_clone_without_tags_has_a_version(clone):
    version = _run(sys.executable, "-m", "setuptools_scm", cwd=clone).strip()  # reads pyproject.toml
    assert re.match(r"1\.0\.1\.dev\d+", version), version


def test_wheel_holds_code_data_and_types(built):
    (wheel,) = built.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        (metadata,) = (name for name in names if name.endswith("/METADATA"))
        text = archive.read(metadata).decode()
    assert "Version: 7.8.9\n" in text
    assert "License-Expression: MIT" in text
    packages = {path.parent.name for path in ROOT.glob("*/py.typed")}
    assert {f"{package}/py.typed" for package in packages} <= set(names)
    sources = [path for package in packages for path in (ROOT / package).rglob("*") if path.is_file()]
    data = [path.relative_to(ROOT).as_posix() for path in sources if path.suffix not in (".pyc", "")]
    assert sorted(set(data) - set(names)) == []
    assert not any(name.startswith(("tests/", "docs/", "benchmarks/")) for name in names)


def test_source_distribution_holds_tests_and_documentation(built):
    (sdist,) = built.glob("*.tar.gz")
    with tarfile.open(sdist) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    for name in (
        "README.md",
        "LICENSE",
        "CHANGELOG.md",
        "docs/conf.py",
        "tests/conftest.py",
        "pyproject.toml",
    ):
        assert name in names


def _python(version):
    """An interpreter of that version, on the path or kept by pyenv; skips where there is none."""
    places = [Path(folder) / f"python{version}" for folder in os.get_exec_path()]
    places += Path.home().glob(f".pyenv/versions/{version}.*/bin/python3")
    for place in places:  # one on the path may be a stand-in for a version that is not there
        if place.is_file() and subprocess.run([place, "--version"], capture_output=True).returncode == 0:
            return place
    pytest.skip(f"no Python {version} here")


@pytest.mark.parametrize("version", OTHERS)
def test_on_every_python_that_is_named_three_solvers_agree(version, built, tmp_path):
    (wheel,) = built.glob("*.whl")
    environment = tmp_path / "environment"
    uv = sys.executable, "-m", "uv"
    _run(*uv, "venv", "--quiet", "--python", _python(version), environment)
    _run(*uv, "pip", "install", "--quiet", "--python", environment / "bin" / "python", wheel)
    assert _run(environment / "bin" / "python", "--version").startswith(f"Python {version}.")
    told = _run(environment / "bin" / "crosscontact", "compare", "elastic-relaxed", cwd=tmp_path)
    assert all(f"{solver} " in told for solver in ("bem", "fem", "reference")), told
    shutil.rmtree(environment)


def test_installed_alone_it_works(installed, tmp_path):
    environment, extra = installed
    _run(environment / "bin" / "pip", "check")
    assert _run(environment / "bin" / "crosscontact", "--version", cwd=tmp_path).split()[-1] == "7.8.9"
    code = f"import crosscontact as cc\nassert cc.__version__ == '7.8.9'\n{TRIED[extra]}"
    _run(
        environment / "bin" / "python",
        "-W",
        "error::DeprecationWarning:crosscontact",
        "-c",
        code,
        cwd=tmp_path,
    )
    if not extra:
        run = ("solve", "relaxed-equilibrium", "--solver", "fem", "--plot", "--out", tmp_path / "out")
        _run(environment / "bin" / "crosscontact", *run, cwd=tmp_path)
        assert {"force.png", "summary.json", "trace.csv"} <= {
            path.name for path in (tmp_path / "out").iterdir()
        }
        _run(environment / "bin" / "crosscontact", "report", "--help", cwd=tmp_path)


def test_installed_alone_it_judges_a_script_in_plain_numpy(installed, tmp_path):
    environment, extra = installed
    if extra:
        pytest.skip("the same with every extra")
    program = environment / "bin" / "crosscontact"
    _run(program, "exam", "export", "exam", cwd=tmp_path)
    script = ROOT / "docs" / "how-to" / "closed_forms.py"
    _run(environment / "bin" / "python", script, "exam", cwd=tmp_path)
    told = _run(program, "judge", "exam", cwd=tmp_path)
    assert "2 verdicts on answers: all passed" in told
    assert "declined by tag: adhesive" in told
