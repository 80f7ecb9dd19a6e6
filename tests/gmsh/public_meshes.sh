#!/bin/sh
# Checks a shell on each mesh of Gmsh in some public packages of Python (170 MB to fetch) and counts what becomes of them:
#   sh tests/gmsh/public_meshes.sh target/release/costate
# A mesh without surfaces is told so; everything else must be read.
set -e
program=$(realpath "$1")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
for package in devsim==2.11.2 mfem==4.10.0.1; do python3 -m pip download -q --no-deps -d . "$package"; done
for package in fipy==4.0.3 meshio==5.3.5 meshmode==2021.2 nutils==9.2 pymesh2==0.1.14 sfepy==2026.3; do
    python3 -m pip download -q --no-deps --no-binary "${package%%=*}" -d . "$package"
done
for own in *.whl; do unzip -q "$own" '*.msh' -d "${own%%-*}"; done
for own in *.tar.gz; do mkdir "${own%%-*}" && tar xzf "$own" -C "${own%%-*}" --wildcards '*.msh'; done
read=0 without=0 refused=0 others=0
find . -name '*.msh' | sort >all
while read -r mesh; do
    # devsim has a format of its own by the same ending
    head -n 1 "$mesh" | grep -q MeshFormat || { others=$((others + 1)); continue; }
    cat >scene.toml <<SCENE
version = 1
settings = { end = 1, steps = 10 }
material.aluminium = { young = 7e10, poisson = 0.3, density = 2700 }
[[mesh]]
name = "shell"
type = "gmsh"
file = "$mesh"
material = "aluminium"
thickness = 0.01
SCENE
    if "$program" check scene.toml >said 2>&1; then
        read=$((read + 1))
    elif grep -q 'the mesh has no faces' said; then
        without=$((without + 1))
    else
        refused=$((refused + 1))
    fi
    printf '%s\n%s\n\n' "$mesh" "$(cut -c 1-300 said)"
done <all
echo "$read meshes are read, $without have no surfaces, $refused are refused, $others files are of other formats"
test "$refused" = 0
