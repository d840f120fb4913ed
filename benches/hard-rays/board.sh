#!/usr/bin/env bash
# Asks every program in peers/ for the answers to hard rays, scores them and those of spherule's
# rungs with both scorers, which must agree, and prints the table of docs/hard-rays.md.
#
# board.sh FOLDER     FOLDER is what `spherule check --export FOLDER` wrote
#
# The answers go beside the others in FOLDER. Run it where npm installed its packages; the head of
# each program names what to install. One that cannot be built or run is left out: exit code 1.
set -euo pipefail

if [ $# -ne 1 ] || [ ! -f "$1/hard-rays.txt" ] || [ ! -f "$1/hard-rays.json" ]; then
    echo "usage: $0 FOLDER, which holds hard-rays.txt and hard-rays.json" >&2
    exit 2
fi
folder=$(realpath "$1")
here=$(dirname "$(realpath "$0")")
peers=$here/peers
rays=$folder/hard-rays.txt
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
left_out=0

# A row of the table, behind what rows are sorted by: the wrong hits and misses of the families,
# then the nearest floats. Of a box only the missed hits count.
row() { # NAME LABEL ANSWERS [box]
    local name=$1 label=$2 answers=$3 kind=${4-}
    "$work/score" "$rays" "$answers" > "$work/table"
    "$here/score.py" "$folder/hard-rays.json" "$answers" > "$work/other"
    if ! cmp -s "$work/table" "$work/other"; then
        echo "$name: the scorers do not agree" >&2
        exit 1
    fi
    awk -v label="$label" -v kind="$kind" '
        function grouped(x) { return x < 1000 ? x : int(x / 1000) "," sprintf("%03d", x % 1000) }
        function counts(from, missed) {
            missed = grouped($(from + 1))
            if (kind == "box") return "– | " missed " | –"
            return grouped($from) " | " missed " | " grouped($(from + 2))
        }
        $1 == "families" { wrong = kind == "box" ? 1e6 : $3 + $4; nearest = $5; families = counts(3) }
        $1 == "all" { all = grouped($2) " | " counts(3) }
        END { printf "%d\t%d\t| %s | %s | %s |\n", wrong, -nearest, label, families, all }
    ' "$work/table" >> "$work/rows"
}

peer() { # NAME LABEL [--box] COMMAND...
    local name=$1 label=$2 kind=
    shift 2
    if [ "$1" = --box ]; then
        kind=box
        shift
    fi
    if "$@" > "$folder/answers-$name.txt" 2> "$work/errors"; then
        row "$name" "$label" "$folder/answers-$name.txt" "$kind"
    else
        echo "left out: $name: $(tail -n 1 "$work/errors")" >&2
        rm -f "$folder/answers-$name.txt"
        left_out=1
    fi
}

build() { # PROGRAM COMPILER ARGUMENTS...
    local program=$1
    shift
    "$@" -o "$work/$program" 2> "$work/errors" || echo "$program: $(tail -n 1 "$work/errors")" >&2
}

cc -std=c99 -O2 -o "$work/score" "$here/score.c"
for rung in certified double compensated robust textbook; do
    row "$rung" "spherule, \`$rung\`" "$folder/answers-$rung.txt"
done

c=(cc -std=c99 -O2 -ffp-contract=off)
cpp=(c++ -O2 -ffp-contract=off)
build formula32 "${c[@]}" "$peers/formula.c" -lm
build formula64 "${c[@]}" -DREAL=double "$peers/formula.c" -lm
build pbrt "${c[@]}" "$peers/pbrt.c" -lm
build embree "${c[@]}" "$peers/embree.c" -lembree3
build glm32 "${cpp[@]}" "$peers/glm.cpp"
build glm64 "${cpp[@]}" -DREAL=double "$peers/glm.cpp"
build cgal "${cpp[@]}" "$peers/cgal.cpp" -lgmp -lmpfr
crates=(cargo run --quiet --release --manifest-path "$peers/rust/Cargo.toml" -- "$rays")

peer formula32 "the textbook's formula in 32 bits" "$work/formula32" "$rays"
peer formula64 "the textbook's formula in 64 bits" "$work/formula64" "$rays"
peer pbrt "pbrt-v4's sphere, as published, in 32 bits" "$work/pbrt" "$rays"
peer embree "Embree 3.13.5, sphere points" "$work/embree" "$rays"
peer embree-robust "Embree 3.13.5, sphere points, \`RTC_SCENE_FLAG_ROBUST\`" "$work/embree" "$rays" robust
peer glm32 "GLM 0.9.9.8, \`intersectRaySphere\` in 32 bits" "$work/glm32" "$rays"
peer glm64 "GLM 0.9.9.8, \`intersectRaySphere\` in 64 bits" "$work/glm64" "$rays"
peer cgal "CGAL 5.5.1, exact spherical kernel" "$work/cgal" "$rays"
peer parry3d "parry3d 0.31.1, \`Ball\` in 32 bits" "${crates[@]}" parry3d
peer parry3d-f64 "parry3d-f64 0.31.1, \`Ball\` in 64 bits" "${crates[@]}" parry3d-f64
peer bvh "bvh 0.13.0, the sphere's box" --box "${crates[@]}" bvh
peer mitsuba "Mitsuba 3.9.1, \`sphere\`" python3 "$peers/mitsuba.py" "$rays"
peer mujoco "MuJoCo 4.0.0, \`mju_rayGeom\` in 64 bits" python3 "$peers/mujoco.py" "$rays"
peer raylib "raylib 5.5, \`GetRayCollisionSphere\` in 32 bits" python3 "$peers/raylib.py" "$rays"
peer povray "POV-Ray 3.7, \`trace()\` in 64 bits" python3 "$peers/povray.py" "$rays"
peer three "three.js r187, \`Ray.intersectSphere\` in 64 bits" node "$peers/three.mjs" "$rays"
peer jolt "Jolt Physics, npm 1.1.0, \`SphereShape\` in 32 bits" node "$peers/jolt.mjs" "$rays"

echo "| program | families: false | missed | nearest | asked in all | false | missed | nearest |"
echo "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
sort -s -n -k1,1 -k2,2 "$work/rows" | cut -f 3-
exit $left_out
