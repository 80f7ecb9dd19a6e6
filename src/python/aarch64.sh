#!/usr/bin/env bash
# Builds the wheel for Linux on aarch64, imports it under QEMU and runs a scene and its gradient. Needs a Debian or Ubuntu with qemu-user-static,
# rustup's target aarch64-unknown-linux-gnu, and `pip install maturin ziglang`. A folder as argument: where all of it is put.
set -euo pipefail
cd "$(dirname "$0")"
folder=$(realpath -m "${1:-../../target/aarch64}")
mkdir -p "$folder"/{lists/partial,cache/archives/partial,system}

maturin build --release --zig --target aarch64-unknown-linux-gnu --compatibility manylinux2014 --interpreter python3.10 --out "$folder"
ls -l "$folder"/costate-*aarch64.whl

# a Python for the other processor, as the system's sources have it, unpacked beside the system
touch "$folder/status"
apt() {
    apt-get -qq -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o Dir::State="$folder" -o Dir::State::status="$folder/status" \
        -o Dir::Cache="$folder/cache" -o Debug::NoLocking=1 "$@"
}
apt update
apt install -y --download-only --no-install-recommends python3 libpython3-stdlib libgcc-s1 libstdc++6
for package in "$folder"/cache/archives/*.deb; do
    dpkg -x "$package" "$folder/system"
done
python=$(realpath -s "$folder"/system/usr/bin/python3.*[0-9])
version=${python##*python}
pip install -q --upgrade --target "$folder/packages" --only-binary=:all: --python-version "$version" \
    --platform manylinux2014_aarch64 --platform manylinux_2_28_aarch64 "$folder"/costate-*aarch64.whl

# not the package that stands in this folder
cd "$folder"
PYTHONPATH="$folder/packages" qemu-aarch64-static -L "$folder/system" "$python" - <<'END'
import platform

import numpy as np

import costate

print(platform.machine(), "Python", platform.python_version(), "costate", costate.__version__)
run = costate.built_in("five-bar").run()
rows = run.gradient().rows
print(f"psi = {run['psi']:.9f}, by its variables", rows[0])
np.testing.assert_allclose(rows, run.complex_step(), rtol=1e-9)
print("agrees with complex steps")
END
