#!/bin/sh
# Renders the pictures of docs/gallery.md from the scenes of this repository.
#
#   sh docs/gallery.sh [--errors] LUMIFLOW [SCENE...]     LUMIFLOW is the program; without scenes, all
#
# ./x gallery builds the program and calls this. The pictures are the same bytes on every run. Their CPU
# seconds are printed; with --errors their errors, too, against references that are rendered for it.
set -eu

errors=
if [ "${1:-}" = --errors ]; then
    errors=yes
    shift
fi
if [ $# -lt 1 ]; then
    echo "usage: sh docs/gallery.sh [--errors] LUMIFLOW [SCENE...]" >&2
    exit 2
fi
lumiflow=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
shift
wanted=" $* "
cd "$(dirname "$0")/.."
mkdir -p docs/gallery
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
trap 'exit 1' INT TERM

# scene NAME SIZE: what follows is of this scene, and this large; false if it is not wanted.
scene() {
    scene=$1
    size=$2
    case "$wanted" in
    "  " | *" $scene "*) ;;
    *) return 1 ;;
    esac
}

# trace NAME INTEGRATOR PASSES [OPTION...]: renders NAME.exr, and says what it took.
trace() {
    name=$1
    integrator=$2
    passes=$3
    shift 3
    [ "$integrator" != erpt ] || set -- --set mutations_per_sample=5 "$@"
    seconds=$("$lumiflow" render "scenes/$scene/scene.xml" -i "$integrator" --passes "$passes" \
        --size "$size" "$@" --quiet --json -o "$out/$name.exr" | sed 's/.*"cpu_s":\([0-9]*\.[0-9]\).*/\1/')
    echo "$name: -i $integrator --passes $passes --size $size $*: $seconds CPU seconds"
}

# show PICTURE NAME [OPTION...]: makes a picture of NAME.exr, with options of convert.
show() {
    picture=$1
    name=$2
    shift 2
    "$lumiflow" convert "$out/$name.exr" "docs/gallery/$picture.png" "$@"
}

# picture NAME INTEGRATOR PASSES [OPTION...]: both, with the error of the image.
picture() {
    trace "$@"
    show "$1" "$1" --exposure "$exposure"
    measure "$1"
}

# filtered NAME FROM: a picture of the filtered layer of FROM.exr. Both errors are of the PNG files, since
# compare does not read layers; the noise of the reference is in them.
filtered() {
    show "$1" "$2" --layer filtered --exposure "$exposure"
    [ -n "$errors" ] || return 0
    "$lumiflow" convert "$out/$2.exr" "$out/unfiltered.png" --exposure "$exposure"
    "$lumiflow" convert "$out/reference.exr" "$out/reference.png" --exposure "$exposure"
    compare "$2, as PNG" "$out/unfiltered.png" "$out/reference.png"
    compare "$1, as PNG" "docs/gallery/$1.png" "$out/reference.png"
}

# reference INTEGRATOR PASSES: what the pictures of this scene are compared with.
reference() {
    [ -z "$errors" ] || trace reference "$@" --seed 1000 --aov variance
}

# measure NAME: the error of NAME.exr, without the noise of the reference.
measure() {
    [ -z "$errors" ] ||
        compare "$1" "$out/$1.exr" "$out/reference.exr" --reference-variance "$out/reference.exr"
}

# compare WHAT IMAGE REFERENCE [OPTION...]: prints the error of an image.
compare() {
    what=$1
    shift
    "$lumiflow" compare "$@" | sed -n "s/^ *corrected */$what: relMSE /p; s/^relMSE */$what: with noise of the reference /p"
}

# The contact sheet: every scene, small, with its size and passes.
for entry in cornell-box:162x136:16 cornell-caustic:162x136:16 door-ajar:180x136:40 glass-in-glass:180x136:16 \
    flow-rules:180x136:12 coloured-mirrors:136x136:16 stratification:180x136:12 indirect-gallery:180x136:16 \
    torus-in-glass:136x136:16 dragon:136x136:24 room:240x136:40 textured-plane:180x136:8; do
    size=${entry#*:}
    if scene "${entry%%:*}" "${size%:*}"; then
        trace "sheet-$scene" erpt "${entry##*:}"
        show "sheet-$scene" "sheet-$scene"
    fi
done

exposure=0
if scene cornell-box 320x268; then
    reference path 2048
    picture cornell-box path 256
fi
if scene cornell-caustic 320x268; then
    reference erpt 60
    picture cornell-caustic path 128
    picture cornell-caustic-bdpt bdpt 55
    picture cornell-caustic-erpt erpt 36
    trace pmc-er pmc-er 32 --set mutations_per_sample=20 --set radii=2,8,32 --set map_cell=4 --aov strategy,acceptance
    show pmc-er-strategy pmc-er --layer strategy
    show pmc-er-acceptance pmc-er --layer acceptance
fi
if scene glass-in-glass 320x240; then
    reference erpt 25
    picture glass-in-glass path 110
    picture glass-in-glass-erpt erpt 30
fi
if scene flow-rules 280x210; then
    trace reference erpt 60 --seed 1000 --aov variance
    show flow-rules-reference reference --layer redistributed
    trace flow-rules-detailed erpt 4 --set flow=detailed
    trace flow-rules-iterated erpt 4 --set flow=iterated --set flow_proposals=2 --set flow_depth=6
    trace flow-rules-equal erpt 8 --set flow=equal --set proposal_filter=box
    for rule in detailed iterated equal; do
        show flow-rules-$rule flow-rules-$rule --layer redistributed
        measure flow-rules-$rule
    done
    show flow-rules-proposals flow-rules-equal --layer proposals --exposure -5
    show flow-rules-expected flow-rules-equal --layer expected_proposals --exposure -5
    show flow-rules-unfiltered flow-rules-equal
    filtered flow-rules-filtered flow-rules-equal
fi
if scene coloured-mirrors 240x240; then
    trace reference erpt 80 --set direct_samples=3 --seed 1000 --aov variance
    show coloured-mirrors-reference reference
    picture coloured-mirrors-path path 32
    for length in 10 100 1000; do
        picture coloured-mirrors-$length erpt 8 --set chain_length=$length --set direct_samples=3
    done
fi
if scene stratification 280x210; then
    trace reference erpt 25 --seed 1000 --aov variance
    show stratification-reference reference
    picture stratification-path path 2
    picture stratification-erpt erpt 1 --set mutations_per_sample=1 --set luminance_samples=10000
    picture stratification-mlt mlt 1 --set mutations_per_pixel=1 --set luminance_samples=10000
fi
filters="--set proposal_filter=box --set consecutive_limit=20"
if scene indirect-gallery 320x240; then
    reference erpt 60
    picture indirect-gallery-path path 52
    # shellcheck disable=SC2086 # several words
    picture indirect-gallery-erpt erpt 24 $filters
    filtered indirect-gallery-filtered indirect-gallery-erpt
    picture indirect-gallery-mlt mlt 13
fi
if scene torus-in-glass 240x240; then
    reference erpt 60
    picture torus-in-glass-path path 44
    # shellcheck disable=SC2086 # several words
    picture torus-in-glass-erpt erpt 12 $filters
    filtered torus-in-glass-filtered torus-in-glass-erpt
    picture torus-in-glass-mlt mlt 8
    size=360x360
    trace torus-in-glass erpt 40
    show torus-in-glass torus-in-glass
fi
exposure=0.5
if scene door-ajar 320x240; then
    reference erpt 50
    picture door-ajar path 150
    picture door-ajar-bdpt bdpt 55
    picture door-ajar-erpt erpt 62
fi
