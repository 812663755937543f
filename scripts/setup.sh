#!/usr/bin/env bash
# Install VASO into .venv: find or bootstrap uv, pick a Python, build PyNuSMV once, sync.
# With the argument "everything", also all optimizers, notebooks and what the tests need.
set -euo pipefail
cd "$(dirname "$0")/.."

say() { printf 'setup: %s\n' "$*" >&2; }
fail() { printf 'setup: error: %s\n' "$*" >&2; exit 1; }

for tool in gcc g++ make; do
    command -v "$tool" >/dev/null || fail "$tool is missing; on Debian or Ubuntu: apt install build-essential"
done

# uv: the one on PATH, or our own in .tools
UV=$(command -v uv || true)
if [ -z "$UV" ]; then
    UV=$PWD/.tools/bin/uv
    if ! [ -x "$UV" ]; then
        say "installing uv into .tools"
        python3 -m venv .tools || fail "no uv, and python3 cannot make an environment; install uv (pip install uv) or python3-venv"
        .tools/bin/pip install --quiet uv || fail "pip could not install uv"
    fi
fi

if [ "${1:-}" = everything ]; then
    say "installing everything that optimizers, notebooks and tests need"
    exec "$UV" sync --frozen --python .venv/bin/python --all-extras --no-extra ros --compile-bytecode
fi

# Python: the first 3.12 or 3.11 that can compile extension modules (has Python.h)
usable='
import pathlib, sys, sysconfig
ok = (3, 11) <= sys.version_info[:2] <= (3, 12)
header = pathlib.Path(sysconfig.get_paths()["include"], "Python.h")
sys.exit(0 if ok and header.exists() else 3 if ok else 1)'
PYTHON=${VASO_PYTHON:-} no_header=
if [ -z "$PYTHON" ]; then
    for candidate in python3 python3.12 python3.11 "$("$UV" python find '>=3.11,<3.13' 2>/dev/null || true)"; do
        command -v "${candidate:-/nonexistent}" >/dev/null || continue
        status=0; "$candidate" -c "$usable" 2>/dev/null || status=$?
        if [ "$status" = 0 ]; then PYTHON=$(command -v "$candidate"); break; fi
        if [ "$status" = 3 ]; then no_header=$candidate; fi
    done
fi
if [ -z "$PYTHON" ]; then
    say "no Python 3.11 or 3.12 ${no_header:+with headers }here; asking uv for one"
    "$UV" python install 3.12 >&2 || {
        [ -z "$no_header" ] || fail "$no_header has no Python.h; on Debian or Ubuntu: apt install python3-dev"
        fail "VASO needs Python 3.11 or 3.12; install one, or set VASO_PYTHON to its path"
    }
    PYTHON=$("$UV" python find --managed-python 3.12)
fi

# PyNuSMV: built here, where its progress is visible; `uv sync` below then takes it from the cache
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
say "PyNuSMV: built from source the first time (1-4 minutes), then taken from a cache"
"$UV" build --wheel --python "$PYTHON" --out-dir "$out" third_party/pynusmv

say "installing the packages of uv.lock into .venv"
"$UV" sync --frozen --inexact --no-dev --python "$PYTHON" --extra adalflow --extra plots --extra synthesis
