#!/bin/sh
# Makes the README's pictures: benches/stars.png, and those of benches/gallery/. Run it again after a change of the
# renderer that can be seen; a test compares its pictures with those that are there.
set -eu
cd "$(dirname "$0")/.."
cargo build --release --bin darkness --example strip
built=${CARGO_TARGET_DIR:-target}/release
PATH=$built:$PATH

darkness render stars -o benches/stars.png
darkness render classic --size 320x180 -o benches/gallery/mask.png
darkness render lit --size 320x180 --inclination 25 -o benches/gallery/above.png
darkness render lit --size 320x180 --radius 6 --inclination 60 --fov 90 -o benches/gallery/near.png
darkness render luminet --size 320x180 -o benches/gallery/luminet.png
darkness render grid --size 320x180 -o benches/gallery/grid.png
darkness render inside --size 320x180 -o benches/gallery/inside.png
"$built/examples/strip" benches/gallery/plunge.png
