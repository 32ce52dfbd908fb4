# Makes a library of COUNT meshes of one triangle in FOLDER, all different, and names what makes their bakes small. To be sourced.

# shellcheck disable=SC2034 # used by whoever sources this
small=(--layers 4 --texture-size 16 --set fins.texture_width=16 --set fins.texture_height=16 --set shells.tile_mm=8
  --set guard.density_per_cm2=40 --set undercoat.density_per_cm2=200 --set guard.length.mm=4 --set undercoat.length.mm=3)

make_library() { # FOLDER COUNT
  mkdir -p "$1"
  for ((i = 0; i < $2; i++)); do
    printf 'v 0 0 0\nv %d.%03d 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n' $((1 + i / 1000)) $((i % 1000)) >"$1/t$i.obj"
  done
}

# Whether two folders hold the same outputs: names and bytes, without what a batch knows of them.
same_outputs() { # A B
  diff -r --exclude=.furrier "$1" "$2"
}
