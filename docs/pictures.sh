#!/bin/sh
# Makes the pictures of README.md and docs/ again, each by the command that stands below it there.
#
#   docs/pictures.sh FURRIER [MONKEY.glb]
#
# FURRIER is the program; MONKEY.glb the head that README.md furs (Blender: Add, Mesh, Monkey, Subdivision 2, smooth), without which
# its picture stays. The picture of three.js is a browser's and not made here. Takes a minute and a half on two cores.
set -eu

furrier=$(realpath "$1")
monkey=${2:+$(realpath "$2")}
images=$(realpath "$(dirname "$0")/images")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# README.md, docs/window.md
"$furrier" bake sample:creature -o creature.glb --preset fox
"$furrier" view creature.glb --screenshot "$images/creature.png" --orbit 50,10,1 --size 800x640
cat > window.txt <<END
resize 800 520
wait
picture $images/window.png
set section.view off
set section.light off
set section.animation off
set section.preset on
set section.preset.guard on
set section.preset.guard.shape on
wait
picture $images/window-parameters.png
set against wipe
set section.preset off
set section.against-the-hair on
wait
picture $images/window-wipe.png
set against error map
wait
picture $images/window-error.png
quit
END
if command -v xvfb-run >/dev/null; then
    xvfb-run -a "$furrier" view sample:creature --preset fox --orbit 50,10,1.25 --script window.txt
fi
if [ -n "$monkey" ]; then
    "$furrier" bake "$monkey" -o furry.glb --preset rabbit
    "$furrier" view furry.glb --screenshot "$images/monkey.png" --orbit 25,10,1 --size 800x640
fi

# docs/recipes.md
cp "$images"/../recipes/* .
"$furrier" bake sample:creature -o painted.glb --set maps.length=length.png --set guard.length.mm=75 --set undercoat.length.mm=40
"$furrier" view painted.glb --screenshot "$images/recipes/painted.png" --orbit 65,10,1 --size 480x400
"$furrier" bake sample:creature -o leopard.glb --preset short-cat --set maps.colour=spots.png
"$furrier" view leopard.glb --screenshot "$images/recipes/leopard.png" --orbit 50,10,1 --size 480x400
# The commands of the recipe itself, as they stand there.
sed -n '/^## Wet/,/^## /p' "$images/../recipes.md" | sed -n '/^```sh/,/^```$/p' | grep -v '^```' | sed "s|^furrier|\"$furrier\"|" > wet.sh
sh wet.sh
cp dry.png wet.png "$images/recipes"

# docs/steps/patch.md, docs/steps/field.md
"$furrier" view creature.glb --screenshot "$images/patches.png" --show patches --orbit 50,10,1 --size 800x640
"$furrier" view creature.glb --screenshot "$images/field.png" --show field --orbit 50,10,1 --size 800x640

# docs/steps/hybrid.md
guard="--set guard.density_per_cm2=60 --size 320x240 --quality final"
for only in guard undercoat hybrid; do
    "$furrier" render sample:cylinder -o "$images/hybrid/cylinder-$only.png" --preset mink $guard --orbit 30,35,0.8 --only $only
    "$furrier" render sample:hat -o "$images/hybrid/hat-$only.png" --preset mink $guard --orbit 35,20,0.85 --only $only
done
for only in guard hybrid; do
    "$furrier" render sample:creature -o "$images/hybrid/creature-$only.png" --preset fox $guard --orbit 50,15,0.45 --only $only
done
