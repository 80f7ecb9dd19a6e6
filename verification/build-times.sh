#!/usr/bin/env bash
# What building takes, from a fresh clone of the current commit: wall and processor time against limits; exit status 1 if one is missed.
#
#     verification/build-times.sh [build] [edit] [test] [crate]     # without arguments: all of them
#
# build  `cargo build --release`, and the size of the binary
# edit   from an edit of an element, of a section of scene files, and of a command to the end of a run, as released and in the profile `dev`
# test   the test command of README.md, nothing built before
# crate  a crate outside with one element and one scene of its own (examples/01_gradient.rs), which depends on the library without its
#        command line: its first build once the library is built, then from an edit of its source to the end of its run
#
# Limits hold for two cores with nothing else running. Needs cargo and a C compiler; downloads are made before the clock starts.
set -euo pipefail
source_folder=$(cd "$(dirname "$0")/.." && pwd)
steps=("$@")
[ $# -gt 0 ] || steps=(build edit test crate)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
git clone --quiet "$source_folder" "$work/costate"
cd "$work/costate"
cargo fetch --quiet
unset CARGO_TARGET_DIR

rows=""
missed=0
# measured NAME VALUE LIMIT UNIT PROCESSOR-SECONDS
row() {
    local verdict=pass
    awk "BEGIN { exit !($2 <= $3) }" || { verdict=FAIL; missed=1; }
    rows+=$(printf '| %s | %s %s | %s %s | %s | %s |' "$1" "$2" "$4" "$3" "$4" "$5" "$verdict")$'\n'
}
# timed NAME LIMIT COMMAND...: runs it and writes its row; its output is shown only if it fails
timed() {
    local name=$1 limit=$2 seconds TIMEFORMAT='%R %U %S'
    shift 2
    echo "$name: $*" >&2
    if ! { time "$@" >"$work/output" 2>&1; } 2>"$work/seconds"; then
        cat "$work/output" >&2
        echo "failed: $*" >&2
        exit 1
    fi
    read -r -a seconds <"$work/seconds"
    row "$name" "${seconds[0]}" "$limit" s "$(awk "BEGIN { print ${seconds[1]} + ${seconds[2]} }")"
}

for step in "${steps[@]}"; do
    case $step in
    build)
        timed "cargo build --release" 150 cargo build --release
        row "size of the binary" "$(awk "BEGIN { printf \"%.1f\", $(wc -c <target/release/costate) / 1e6 }")" 16 MB ""
        ;;
    edit)
        for profile in release dev; do
            arguments=(run --profile "$profile" --bin costate -- run pendulum --steps 10 --no-report --out "$work/out")
            cargo "${arguments[@]}" >"$work/output" 2>&1
            limits=(60 20 20)
            [ "$profile" = release ] || limits=(15 15 15)
            for file in src/elements/bodies/point_mass.rs src/scenes/file/parts/spin.rs src/cli/list.rs; do
                # a function that nothing calls: the crate is compiled anew
                printf '\n#[doc(hidden)]\npub fn edited_%s() {}\n' "$profile" >>"$file"
                timed "edit of $file to a run, $profile" "${limits[0]}" cargo "${arguments[@]}"
                limits=("${limits[@]:1}")
            done
        done
        git checkout --quiet .
        ;;
    test)
        read -r -a command <<<"$(grep -m1 '^cargo test' README.md)"
        export CARGO_TARGET_DIR=$work/test
        timed "${command[*]}" 480 "${command[@]}"
        unset CARGO_TARGET_DIR
        ;;
    crate)
        mkdir -p "$work/own/src"
        cd "$work/own"
        cat >Cargo.toml <<'TOML'
[package]
name = "own"
version = "0.1.0"
edition = "2024"

[dependencies]
costate = { path = "../costate", default-features = false }
TOML
        # the library first, by a crate that does nothing with it
        echo 'use costate as _; fn main() {}' >src/main.rs
        cp ../costate/Cargo.lock .
        timed "the library without its command line" 150 cargo build --release
        cp ../costate/examples/01_gradient.rs src/main.rs
        touch src/main.rs
        timed "a crate of one element and one scene, first build" 15 cargo build --release
        cargo run --release --quiet >/dev/null
        # a constant of the element's force
        sed -i '0,/p\[2\] \* s.q\[0\]/s//p[2] * 1.0000001 * s.q[0]/' src/main.rs
        grep -q 1.0000001 src/main.rs || { echo "no formula to edit in examples/01_gradient.rs" >&2; exit 1; }
        timed "the same, from edit to run" 5 cargo run --release
        cd "$work/costate"
        ;;
    *)
        echo "no step is named $step: build, edit, test, crate" >&2
        exit 2
        ;;
    esac
done

printf '\n| %s, %s cores | measured | limit | processor [s] | verdict |\n|---|---:|---:|---:|---|\n%s' \
    "$(git rev-parse --short HEAD)" "$(nproc)" "$rows"
exit $missed
