#!/usr/bin/env bash
# Puts the site together in DIR: the programs, small, the pages, the models and the pictures, and how large each file is.
# build.sh DIR checks makes only the pages without Bevy work, which takes a few minutes.
set -euo pipefail
cd "$(dirname "$0")/.."
site=${1:?a folder to put the site into}
target=${CARGO_TARGET_DIR:-target}
work=$target/web-work

wanted=$(sed -n '/^name = "wasm-bindgen"$/{n;s/^version = "\(.*\)"$/\1/p}' Cargo.lock)
have=$(wasm-bindgen --version 2>/dev/null | cut -d' ' -f2 || true)
[ "$have" = "$wanted" ] || { echo "wasm-bindgen $wanted is needed, here is ${have:-none}: just web-tools" >&2; exit 1; }
[ -x web/node_modules/.bin/wasm-opt ] || { echo "wasm-opt is needed: just web-tools" >&2; exit 1; }

mkdir -p "$work"
# Builds the program of a package and shrinks it: build NAME PACKAGE FEATURES
build() {
    local name=$1 package=$2
    cargo build --profile web --target wasm32-unknown-unknown -p "$package" "${@:3}"
    wasm-bindgen --target web --no-typescript --remove-name-section --remove-producers-section --out-dir "$work" --out-name "$name" \
        "$target/wasm32-unknown-unknown/web/$package.wasm"
    # Takes a quarter of an hour for the large program, so it is only done for another program.
    if ! cmp -s "$work/${name}_bg.wasm" "$work/${name}_shrunk_from.wasm"; then
        web/node_modules/.bin/wasm-opt -Oz --enable-simd --enable-bulk-memory --enable-sign-ext --enable-nontrapping-float-to-int \
            --enable-reference-types --enable-multivalue --enable-mutable-globals --enable-extended-const \
            "$work/${name}_bg.wasm" -o "$work/${name}_shrunk.wasm"
        cp "$work/${name}_bg.wasm" "$work/${name}_shrunk_from.wasm"
    fi
}
programs=(checks)
build checks morph_collision_web_checks
if [ "${2:-}" != checks ]; then
    programs+=(shows physics)
    build shows morph_collision_web
    build physics morph_collision_web --features physics
fi

rm -rf "$site"
mkdir -p "$site/assets" "$site/pictures"
for name in "${programs[@]}"; do
    cp "$work/$name.js" "$site/$name.js"
    cp "$work/${name}_shrunk.wasm" "$site/${name}_bg.wasm"
done
cp web/pages/* "$site/"
# The models and pictures that the pages name.
grep -oh 'data-\(files\|sample\)="[^"]*"\|giveSample("[^"]*")' web/pages/*.html web/pages/*.js | grep -o '[a-z0-9_]\+\.glb' | sort -u | sed 's#^#assets/#' | xargs cp -t "$site/assets"
grep -o 'pictures/[a-z0-9_]*\.[a-z]*' web/pages/index.html | sort -u | sed 's#^#docs/#' | xargs cp -t "$site/pictures"

cd "$site"
separator=""
{
    echo "{"
    for file in *_bg.wasm assets/*; do
        printf '%s  "%s": { "raw": %d, "gzip": %d }' "$separator" "$file" "$(stat -c %s "$file")" "$(gzip -9 -c "$file" | wc -c)"
        separator=$',\n'
    done
    printf '\n}\n'
} > sizes.json
echo "the site is in $site:"
cat sizes.json
