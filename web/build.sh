#!/usr/bin/env bash
# Puts the site together in DIR: the program, small, the pages, the models and the pictures, and how large each file is.
set -euo pipefail
cd "$(dirname "$0")/.."
site=${1:?a folder to put the site into}
target=${CARGO_TARGET_DIR:-target}
work=$target/web-work

wanted=$(sed -n '/^name = "wasm-bindgen"$/{n;s/^version = "\(.*\)"$/\1/p}' Cargo.lock)
have=$(wasm-bindgen --version 2>/dev/null | cut -d' ' -f2 || true)
[ "$have" = "$wanted" ] || { echo "wasm-bindgen $wanted is needed, here is ${have:-none}: just web-tools" >&2; exit 1; }
[ -x web/node_modules/.bin/wasm-opt ] || { echo "wasm-opt is needed: just web-tools" >&2; exit 1; }

cargo build --profile web --target wasm32-unknown-unknown -p morph_collision_web
mkdir -p "$work"
wasm-bindgen --target web --no-typescript --remove-name-section --remove-producers-section --out-dir "$work" --out-name morph \
    "$target/wasm32-unknown-unknown/web/morph_collision_web.wasm"
# Takes a quarter of an hour, so it is only done for another program.
if ! cmp -s "$work/morph_bg.wasm" "$work/shrunk_from.wasm"; then
    web/node_modules/.bin/wasm-opt -Oz --enable-simd --enable-bulk-memory --enable-sign-ext --enable-nontrapping-float-to-int \
        --enable-reference-types --enable-multivalue --enable-mutable-globals --enable-extended-const \
        "$work/morph_bg.wasm" -o "$work/shrunk.wasm"
    cp "$work/morph_bg.wasm" "$work/shrunk_from.wasm"
fi

rm -rf "$site"
mkdir -p "$site/assets" "$site/pictures"
cp "$work/morph.js" "$site/morph.js"
cp "$work/shrunk.wasm" "$site/morph_bg.wasm"
cp web/pages/* "$site/"
# The models and pictures that the pages name.
grep -oh '[a-z0-9_]\+\.glb' web/pages/*.html web/pages/own.js | sort -u | sed 's#^#assets/#' | xargs cp -t "$site/assets"
grep -o 'src="pictures/[^"]*"' web/pages/index.html | sed 's#src="pictures/\(.*\)"#docs/pictures/\1#' | sort -u | xargs cp -t "$site/pictures"

cd "$site"
separator=""
{
    echo "{"
    for file in morph_bg.wasm assets/*; do
        printf '%s  "%s": { "raw": %d, "gzip": %d }' "$separator" "$file" "$(stat -c %s "$file")" "$(gzip -9 -c "$file" | wc -c)"
        separator=$',\n'
    done
    printf '\n}\n'
} > sizes.json
echo "the site is in $site:"
cat sizes.json
