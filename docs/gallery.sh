#!/bin/sh
# Renders the pictures of docs/gallery.md from the scenes of this repository.
#
#   sh docs/gallery.sh LUMIFLOW [NAME...]     LUMIFLOW is the program; without names, all pictures
#
# ./x gallery builds the program and calls this. The pictures are the same bytes on every run.
set -eu

if [ $# -lt 1 ]; then
    echo "usage: sh docs/gallery.sh LUMIFLOW [NAME...]" >&2
    exit 2
fi
lumiflow=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
shift
wanted=" $* "
cd "$(dirname "$0")/.."
mkdir -p docs/gallery

# picture NAME SPP [OPTION...]: renders scenes/NAME to docs/gallery/NAME.png.
picture() {
    name=$1
    spp=$2
    shift 2
    case "$wanted" in
    "  " | *" $name "*) ;;
    *) return 0 ;;
    esac
    echo "+ lumiflow render scenes/$name/scene.xml --spp $spp $* -o docs/gallery/$name.png" >&2
    "$lumiflow" render "scenes/$name/scene.xml" --spp "$spp" "$@" -o "docs/gallery/$name.png"
}

picture cornell-box 256 --size 320x268
picture cornell-caustic 256 --size 320x268
picture door-ajar 512 --exposure 0.5
picture glass-in-glass 512
