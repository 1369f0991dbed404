# Recipes for developers and CI. `just` lists them.

# The program of the laboratory, optimised.
lab := "cargo run --quiet --release -p morph_collision_testkit --"

default:
    @just --list

# The order lets later steps reuse what earlier ones compiled: clippy and the docs share one build of Bevy, tests and examples another,
# and all release steps a third one without Bevy. `licences` is last because .ci/run compiles what it needs meanwhile.
# The checks that must pass before a change lands: about half an hour on two cores.
ci: fmt-check spell clippy doc test demo-check package-list determinism-release first-picture instructions-check crowds-check verify-short licences

# Everything must be committed, because packages are made from commits. Run the part that a change touches before it lands.
# What a change rarely breaks, or what takes long. Run it before a release.
nightly: package first-run features test-drawing verify stress determinism-wasm (fuzz "60") deny

# What contributors run while they work: formatting, spelling, clippy, and the tests of the core and the plugin.
quick: fmt-check spell clippy
    # As in `just test`, so that both share what they compile.
    cargo test --workspace --lib --test contacts --test one_body --test skinned --test truth --test plugin

# Formats the code.
fmt:
    cargo fmt --all

fmt-check:
    cargo fmt --all -- --check

# Checks the spelling; typos.toml has the project's words (needs pip install typos, or cargo install typos-cli --locked).
spell:
    #!/usr/bin/env bash
    set -euo pipefail
    if ! command -v typos > /dev/null; then echo "skipped: the spelling is not checked, because typos is not installed"; exit; fi
    typos

clippy:
    cargo clippy --workspace --all-targets --all-features -- -D warnings

# The README's test command.
test:
    cargo test --workspace

# All tests, also those that draw (Debian: apt install mesa-vulkan-drivers libvulkan1).
test-drawing:
    cargo test --workspace --all-features

# Checks the published crates with each feature separately. Each one compiles a part of Bevy again.
features:
    #!/usr/bin/env bash
    set -euo pipefail
    for feature in serde rayon; do cargo check -p morph_collision --no-default-features --features "$feature"; done
    for feature in "" gltf picking gizmos diagnostics diagnostic_ui; do
        cargo check -p bevy_morph_collision --no-default-features --features "$feature"
    done
    for feature in "" tnua; do cargo check -p bevy_morph_avian --no-default-features --features "$feature"; done

# Packages the published crates and builds each one from its package (the last one compiles Bevy).
package:
    cargo package -p morph_collision -p morph_collision_models -p morph_collision_cli -p bevy_morph_collision -p bevy_morph_physics -p bevy_morph_rapier -p bevy_morph_avian

# Packages them without building: checks manifests and the lists of files.
package-list:
    cargo package --allow-dirty --no-verify -p morph_collision -p morph_collision_models -p morph_collision_cli -p bevy_morph_collision -p bevy_morph_physics -p bevy_morph_rapier -p bevy_morph_avian

# Lists the public items of a published crate (cargo install cargo-public-api --locked; rustup toolchain install nightly --profile minimal).
public-api CRATE="morph_collision":
    cargo public-api --all-features --omit blanket-impls,auto-trait-impls,auto-derived-impls -p {{CRATE}}

# Compares the public API with the last release on crates.io, or with BASELINE, a commit (cargo install cargo-semver-checks --locked).
semver-checks BASELINE="":
    #!/usr/bin/env bash
    set -euo pipefail
    baseline=({{ if BASELINE == "" { "" } else { "--baseline-rev " + BASELINE } }})
    # The models and the tool promise no stable API.
    cargo semver-checks --all-features -p morph_collision -p bevy_morph_collision -p bevy_morph_physics -p bevy_morph_rapier -p bevy_morph_avian "${baseline[@]}"

# Checks licences and sources of dependencies by deny.toml. Advisories need access to GitHub, so only `deny` checks them.
licences:
    #!/usr/bin/env bash
    set -euo pipefail
    if command -v cargo-deny > /dev/null; then
        cargo deny check licenses bans sources
    else
        echo "licences are not checked, because cargo-deny is not installed"
        # In CI they must be.
        test -z "${CI:-}"
    fi

# Checks licences, sources and advisories of dependencies by deny.toml (needs cargo install cargo-deny --locked).
deny *CHECKS:
    cargo deny check {{CHECKS}}

# Checks that answers have the same bits in debug and release, for several leaf sizes, on any number of threads.
determinism: && determinism-release
    cargo test -p morph_collision_testkit --test determinism

# The release half of it; the tests are the other half. Built together with the command-line tool, so that both share dependencies.
determinism-release: release
    "${CARGO_TARGET_DIR:-target}/release/morph-lab" determinism

# The release half on emulated 64-bit Arm, on one thread, to run the NEON kernels. On Debian: apt install gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user
determinism-aarch64:
    #!/usr/bin/env bash
    set -euo pipefail
    rustup target add aarch64-unknown-linux-gnu
    export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc
    export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER="qemu-aarch64 -L /usr/aarch64-linux-gnu"
    output=$(cargo run --release --target aarch64-unknown-linux-gnu -p morph_collision_testkit --bin morph-lab -- determinism --threads 1)
    echo "$output"
    grep -q 'kernels: neon$' <<< "$output"

# The release half for this processor only, with all its instructions, such as fused multiply and add. Compiles everything anew.
determinism-native:
    RUSTFLAGS="-C target-cpu=native" cargo run --release --target-dir "${CARGO_TARGET_DIR:-target}/native" -p morph_collision_testkit --bin morph-lab -- determinism

# The same check in WebAssembly, compiled like the web site but run without a browser (needs Node.js).
determinism-wasm:
    #!/usr/bin/env bash
    set -euo pipefail
    rustup target add wasm32-wasip1
    RUSTFLAGS="-C target-feature=+simd128" cargo build --profile web -p morph_collision_testkit --bin morph-lab --target wasm32-wasip1
    node --no-warnings --input-type=module - "${CARGO_TARGET_DIR:-target}/wasm32-wasip1/web/morph-lab.wasm" <<'END'
    import { readFile } from "node:fs/promises";
    import { WASI } from "node:wasi";
    const wasi = new WASI({ version: "preview1", args: ["morph-lab", "determinism"] });
    const { instance } = await WebAssembly.instantiate(await readFile(process.argv[2]), wasi.getImportObject());
    process.exit(wasi.start(instance));
    END

# Builds the command-line tool and the laboratory.
release:
    cargo build --release -p morph_collision_cli -p morph_collision_testkit --bin morph-collide --bin morph-lab

# Builds the docs of libraries and the tool. With two of the examples, dependencies have the same features as for clippy; otherwise Bevy would be checked again.
doc:
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --all-features --no-deps --lib --bin morph-collide --example dolphins --example hat

# `first-run` would compile all again, because the tool alone needs fewer features of what it depends on.
# Draws the picture of the README's first command with the tool that other release steps have built.
first-picture PICTURE="dolphins.png": release
    "${CARGO_TARGET_DIR:-target}/release/morph-collide" run assets/scenes/two_dolphins.json --picture {{PICTURE}}

# The README's first command: draws a picture of touching dolphins. Needs only Rust and a C linker.
first-run PICTURE="dolphins.png":
    cargo run --release -p morph_collision_cli -- run assets/scenes/two_dolphins.json --picture {{PICTURE}}

# Shows the dolphins in a window. Without a display: just demo --screenshots out.
demo *ARGS:
    cargo run --release --features render --example dolphins -- {{ARGS}}

# Runs a program of the cookbook in a window: just cookbook face_zones.
cookbook NAME:
    #!/usr/bin/env bash
    set -euo pipefail
    cd "{{justfile_directory()}}"
    package=$(basename "$(dirname "$(dirname crates/bevy_morph_*/examples/{{NAME}}.rs)")")
    BEVY_ASSET_ROOT=$PWD cargo run -p "$package" --all-features --example {{NAME}}

# Checks that the examples find collisions. They are built with the same features as for the tests.
demo-check:
    #!/usr/bin/env bash
    set -euo pipefail
    cargo build --workspace --example dolphins --example crowd --example physics --example character --example slap --example dust --example netcode
    summary=$("${CARGO_TARGET_DIR:-target}/debug/examples/dolphins" --headless --json)
    echo "$summary"
    grep -Eq '"events_started": *[1-9]' <<< "$summary"
    crowd=$("${CARGO_TARGET_DIR:-target}/debug/examples/crowd" --headless --instances 60 --frames 5 --json)
    echo "$crowd"
    grep -Eq '"dense":.*"pairs": *[1-9]' <<< "$crowd"
    rain=$("${CARGO_TARGET_DIR:-target}/debug/examples/physics" --headless --bodies 40 --frames 300 --json)
    echo "$rain"
    grep -Eq '"fell_through": *0,.*"player_grounded": *(1|0\.9)[0-9.]*,.*"player_walked": *[1-9]' <<< "$rain"
    character=$("${CARGO_TARGET_DIR:-target}/debug/examples/character" --headless --frames 400 --json)
    echo "$character"
    grep -Eq '"kicks": *[1-9].*"frames_hand_on_face": *[1-9]' <<< "$character"
    slap=$("${CARGO_TARGET_DIR:-target}/debug/examples/slap" --headless --slaps 2 --json)
    echo "$slap"
    grep -Eq '"slaps": *2,"felt_discrete": *0,"felt_continuous": *2' <<< "$slap"
    dust=$("${CARGO_TARGET_DIR:-target}/debug/examples/dust" --headless --frames 60 --json)
    echo "$dust"
    grep -Eq '"most_on_skin": *[1-9]' <<< "$dust"
    netcode=$("${CARGO_TARGET_DIR:-target}/debug/examples/netcode" --json)
    echo "$netcode"
    grep -Eq '"is_in_sync": *true' <<< "$netcode"

# Compares SEEDS runs that are rolled back at random with runs that are not.
rollback SEEDS="200":
    MORPH_COLLISION_SEEDS={{SEEDS}} cargo test --workspace --test plugin -- rollback --nocapture

# Moves continuous colliders to extremes, 200 operations for each of SEEDS seeds, and checks the work of every frame.
torture SEEDS="200":
    MORPH_COLLISION_SEEDS={{SEEDS}} cargo test --workspace --test plugin -- no_update_takes_more --nocapture

# Tries every feature with every kind of collider, and writes docs/combinations.md.
combinations:
    MORPH_COLLISION_STORE_TABLES=1 cargo test --workspace --test plugin -- combinations --nocapture

# Regenerates the pictures of README and docs, with or without a GPU or display.
pictures:
    #!/usr/bin/env bash
    set -euo pipefail
    cargo run --release -p morph_collision_cli -- run assets/scenes/two_dolphins.json --picture docs/pictures/two_dolphins.png
    draw() { cargo run --quiet --release --features render --example "$1" -- --screenshots docs/pictures "${@:2}"; }
    draw dolphins --triangles 2256 --bare --size 432x243 --at 60 --animate 0..394:6
    draw dolphins --triangles 2256 --bare --size 960x540
    draw pass_through --bare --size 480x400
    draw face --bare --size 640x640 --at 60,192
    draw character --size 960x540 --at 66,200
    draw slap --size 960x540 --at 38
    draw dust --size 960x540 --at 150
    draw picking --size 960x540 --at 60
    draw culling --size 960x540 --at 90
    draw physics --size 960x540 --at 180
    draw crowd --size 960x540 --at 10
    draw own --bare --size 960x540 --at 140
    cargo run --quiet --release --features render --example dolphins -- --screenshots docs/pictures/volumes \
        --triangles 2256 --size 960x540 --at 60 --volumes 3

# Builds the examples as a web site in target/web-site (takes half an hour the first time).
web:
    web/build.sh target/web-site

# Serves that site on this machine only.
serve PORT="8080":
    @echo "http://localhost:{{PORT}}"
    python3 -m http.server {{PORT}} --bind 127.0.0.1 --directory target/web-site

# Tests the site in Chromium (CHROMIUM=PATH if it is not /usr/bin/chromium). Screenshots of the pages go to target/web-pictures.
web-test: web
    node --test --test-concurrency=1 web/tests/*.test.mjs

# Only the determinism test, without building Bevy: in Chromium, and in Firefox if there is one (FIREFOX=PATH if it is not /usr/bin/firefox).
web-answers:
    web/build.sh target/web-answers checks
    SITE=target/web-answers node --test web/tests/answers.test.mjs

# Regenerates the pictures of pages in docs/gallery.md and docs/lint.md from the site.
web-pictures: web
    node web/pictures.mjs docs/pictures/site

# Installs the tools for the web recipes, except Node.js, Python and Chromium: the target, wasm-bindgen in the version of Cargo.lock, and the npm packages.
web-tools:
    rustup target add wasm32-unknown-unknown
    cargo install wasm-bindgen-cli --version "$(sed -n '/^name = "wasm-bindgen"$/{n;s/^version = "\(.*\)"$/\1/p}' Cargo.lock)"
    npm ci --prefix web

# Updates the reference pictures of the render tests. Look at them before you commit them.
references:
    MORPH_COLLISION_STORE_REFERENCES=1 cargo test --workspace --all-features --test render references::

# Regenerates the models and scenes in assets/. The result is identical, bit for bit.
assets:
    {{lab}} make-assets assets

# Searches for vertices outside their blended boxes: at least CHECKS checks for each leaf size, ten million by default.
containment *CHECKS:
    {{lab}} containment {{CHECKS}}

# Compares the answers about every model in assets/ and ../shared/models with brute force: FRAMES situations, several leaf sizes, three seeds.
verify FRAMES="30":
    #!/usr/bin/env bash
    set -euo pipefail
    for model in assets/*.glb ../shared/models/*.glb ../shared/models/*.gltf; do
        test -f "$model" || continue
        for seed in 1 2 3; do
            echo "$model"
            {{lab}} verify "$model" --frames {{FRAMES}} --seed $seed
        done
    done

# Compares the plugin's rays, pairs and culling boxes for skinned characters with brute force, in every frame of every clip at 60 Hz.
characters:
    MORPH_COLLISION_EVERY_FRAME=1 cargo test -p morph_collision_workspace --all-features --test plugin skins::characters -- --nocapture

# Tests difficult generated input: CASES cases (200 by default) of every family, three seeds.
stress CASES="200":
    #!/usr/bin/env bash
    set -euo pipefail
    for seed in 1 2 3; do
        {{lab}} stress --cases {{CASES}} --seed $seed
    done

# A short version of verify and stress, for CI.
verify-short: release
    #!/usr/bin/env bash
    set -euo pipefail
    release="${CARGO_TARGET_DIR:-target}/release"
    "$release/morph-collide" inspect assets/dolphin_564.glb
    # Each takes one thread.
    printf '%s\n' "verify assets/dolphin_564.glb --frames 50" "stress --cases 54" \
        "verify assets/dolphin_2256.glb assets/pass_through_20480.glb --frames 10" | xargs -P "$(nproc)" -L 1 "$release/morph-lab"

# Fuzzes the targets one after another for SECONDS each, regressions first (needs cargo install cargo-fuzz --locked and a C++ compiler).
fuzz SECONDS:
    #!/usr/bin/env bash
    set -euo pipefail
    # There is no unsafe code, so no sanitizer is needed, and any toolchain works without one.
    cargo fuzz build --sanitizer none
    for target in $(cargo fuzz list); do
        # The same function, with mutations that keep the structure of files.
        corpus="${target%_structure}"
        mkdir -p "fuzz/corpus/$corpus" "fuzz/regressions/$corpus"
        regressions=(fuzz/regressions/"$corpus"/*)
        if [ -e "${regressions[0]}" ]; then
            cargo fuzz run --sanitizer none "$target" "${regressions[@]}"
        fi
        dictionary=()
        if [ -e "fuzz/dictionaries/$corpus.txt" ]; then dictionary=(-dict="fuzz/dictionaries/$corpus.txt"); fi
        # New inputs go to the first folder, which is not committed.
        mkdir -p "fuzz/target/corpus/$target"
        # Limits the address space of file readers, in KiB: they must refuse a file that claims gigabytes.
        limit=unlimited
        case "$target" in gltf* | scene | layout | tree_file) limit=2000000 ;; esac
        (ulimit -v "$limit"; cargo fuzz run --sanitizer none "$target" "fuzz/target/corpus/$target" "fuzz/corpus/$corpus" -- \
            -max_total_time={{SECONDS}} -max_len=4096 -timeout=10 -print_final_stats=1 "${dictionary[@]}")
    done

# Feeds mutated files to the readers of models, scenes and trees for SECONDS, within 2 GB of address space.
mutations SECONDS="900" SEED="1":
    cargo build -p morph_collision_testkit --bin morph-lab
    ulimit -v 2000000; "${CARGO_TARGET_DIR:-target}/debug/morph-lab" mutations {{SECONDS}} {{SEED}}

# Plays a game without a window for FRAMES frames, twice at the same time and then while models are loaded again, and fails if memory grows, a contact never ends, a frame has too much work, or the first two differ. 1728000 frames are eight hours.
soak FRAMES="36000" SEED="1":
    #!/usr/bin/env bash
    set -euo pipefail
    cargo build --release -p morph_collision_workspace --example soak
    results=$(mktemp -d)
    trap 'rm -r "$results"' EXIT
    # A copy, so that it may be built again meanwhile. It looks for the models where it was built.
    cp "${CARGO_TARGET_DIR:-target}/release/examples/soak" "$results/soak"
    "$results/soak" --frames {{FRAMES}} --seed {{SEED}} > "$results/second" 2>&1 &
    second=$!
    "$results/soak" --frames {{FRAMES}} --seed {{SEED}} --progress 100000 | tee "$results/first"
    wait $second || { cat "$results/second"; exit 1; }
    hash() { grep '^ *hash ' "$results/$1"; }
    if [ "$(hash first)" != "$(hash second)" ]; then echo "the second run differs:"; cat "$results/second"; exit 1; fi
    "$results/soak" --frames {{FRAMES}} --seed {{SEED}} --reload-in-play --progress 100000

# --only TOPIC measures one page, --quick makes rough numbers, --render only writes the pages again.

# Measures everything in docs/measurements and writes its pages, docs/performance.md and the README's numbers.
report *ARGS:
    {{lab}} report {{ARGS}} docs

# Regenerates the tables and plots of a page in place: rapier, avian, characters, continuous, crowds or tolerance (--quick, --only TABLE).
plugin-report PAGE *ARGS:
    cargo run --release -p morph_collision_workspace --example report -- {{PAGE}} {{ARGS}}

# Times the library's queries on this machine: all, or only those whose name contains NAME.
bench *NAME:
    cargo bench -p morph_collision_testkit --bench queries -- {{NAME}}

# Counts the instructions of 20 frames of the bench scenes, in millions (needs valgrind). Default: all scenes.
instructions *SCENES: (instructions-of "morph" SCENES)

# The same for ours, for the hybrid and the full refit, both with our code, and for bodies that do not deform.
instructions-rivals *SCENES: (instructions-of "morph hybrid bottom-up rigid-floor" SCENES)

[private]
instructions-of METHODS *SCENES: release
    #!/usr/bin/env bash
    set -euo pipefail
    export lab="${LAB:-${CARGO_TARGET_DIR:-target}/release/morph-lab}"
    export counts=$(mktemp -d)
    trap 'rm -r "$counts"' EXIT
    count() {
        column=$2
        if [ "{{METHODS}}" != morph ]; then column=$3,$2; fi
        # The first pass and the set-up are not counted.
        if output=$(valgrind --tool=callgrind --callgrind-out-file=/dev/null '--toggle-collect=*counted_frame*' "$lab" frames $1 $2 --method $3 2>&1); then
            awk -v s=$1 -v w=$column -v n="$(sed -n 's/.*Collected : //p' <<< "$output")" 'BEGIN { printf "%-20s %-6s %10.3f\n", s, w, n / 1e6 }' > "$counts/$1 $2 $3"
        elif [ $2 = all ]; then
            echo "skipped: $(sed -n 's/^morph-lab: error: //p' <<< "$output")" >&2
        fi
    }
    export -f count
    scenes="{{SCENES}}"
    # Several at once: the load of the machine does not change the counts.
    for scene in ${scenes:-pass-through-20480 dolphins-564 dolphins-9024 dolphins-36096 heads-cheek heads-crowd horse-gallop samba walkers-hands walkers-deep walkers-crowd blobs pass-through-5120 head-ray head-rays walkers-ray walkers-rays}; do
        for method in {{METHODS}}; do
            echo "$scene all $method"
            echo "$scene first $method"
        done
    done > "$counts/order"
    xargs -P "$(nproc)" -L 1 bash -c 'count $0 $1 $2' < "$counts/order"
    while read -r run; do
        if [ -e "$counts/$run" ]; then cat "$counts/$run"; fi
    done < "$counts/order"

# Counts the instructions of a step, in thousands, of a discrete query and of queries about the motion, over speed (needs valgrind).
instructions-motion:
    #!/usr/bin/env bash
    set -euo pipefail
    cargo build --release -p morph_collision_testkit --bin morph-lab
    lab="${CARGO_TARGET_DIR:-target}/release/morph-lab"
    for place in apart beside through; do
        for speed in 0 0.01 0.1 1 10; do
            for question in discrete motion first; do
                output=$(valgrind --tool=callgrind --callgrind-out-file=/dev/null '--toggle-collect=*counted_step*' "$lab" steps $place $speed $question 2>&1)
                awk -v of="$place $speed $question" -v n="$(sed -n 's/.*Collected : //p' <<< "$output")" 'BEGIN { printf "%s %.1f\n", of, n / 40 / 1000 }'
                if [ $question != first ]; then
                    echo "$place $speed touch-$question $(sed -n 's/^touch in \([0-9]*\) of .*/\1/p' <<< "$output")"
                fi
            done
        done
    done

# Counts the instructions of a frame of a crowd of docs/crowds.md (idle, moving, dense or clip; with nothing, collisions or bounds), in thousands: all, and the plugin's systems (needs valgrind).
instructions-run CROWD="idle" WITH="collisions":
    #!/usr/bin/env bash
    set -euo pipefail
    # As in `just test`, so that both share what they compile.
    cargo build --workspace --example report
    counts=$(mktemp)
    trap 'rm "$counts"' EXIT
    valgrind --fair-sched=yes --tool=callgrind "--callgrind-out-file=$counts" '--toggle-collect=*counted_update*' \
        "${CARGO_TARGET_DIR:-target}/debug/examples/report" crowds --count-run {{CROWD}} --with {{WITH}} 2>&1 |
        awk '/Collected : / { printf "%10.1f all\n", $NF / 4 / 1000 }'
    # Four frames are counted. A system's function may be inlined, but not one of those that run it, whose types name it last. They call each
    # other, so the largest count is that of the system.
    callgrind_annotate --inclusive=yes --threshold=100 "$counts" 2> >(grep -v '^Use of uninitialized value' >&2) |
        sed -n 's/^ *\([0-9,]*\) .*, bevy_morph_collision\(\(::[a-z_]*\)*\)> as bevy_ecs::system::system::System>::run[a-z_]* \[.*/\1 \2/p' |
        awk '{ gsub(",", "", $1); sub("^.*::", "", $2); if ($1 + 0 > most[$2] + 0) most[$2] = $1 }
            END { for (name in most) { printf "%10.1f %s\n", most[name] / 4 / 1000, name; sum += most[name] } printf "%10.1f all systems\n", sum / 4 / 1000 }' |
        sort -rn

# Prints the table of docs/tool.md: what every command says about every model in assets/, ../shared/models and ../shared/field.
tool-table:
    #!/usr/bin/env bash
    set -euo pipefail
    cargo build -p morph_collision_cli -p morph_collision_testkit --bin morph-collide --bin morph-lab
    tool="${CARGO_TARGET_DIR:-target}/debug/morph-collide"
    lab="${CARGO_TARGET_DIR:-target}/debug/morph-lab"
    scratch=$(mktemp -d)
    trap 'rm -r "$scratch"' EXIT
    # The part in brackets of the lines that match.
    told() { sed -n "s/$1/\\1/p" | tr '\n' ' ' | sed 's/ $//'; }
    # Some of the small files are refused, which their row then shows.
    try() { "$tool" "$@" 2> /dev/null || true; }
    commas() { sed ':a; s/\B[0-9]\{3\}\b/,&/; ta'; }
    echo "| model | inspect | query --self | sweep --fps 10 | export --mesh all | run | motion | verify | bench |"
    echo "|---|--:|--:|--:|--:|--:|--:|--:|---|"
    for model in assets/*.glb ../shared/models/*.glb ../shared/models/*.gltf ../shared/models/sequences/*.glb ../shared/field/*.glb; do
        test -f "$model" || continue
        # Some models are in both folders.
        if [ "${model#assets/}" = "$model" ] && [ -f "assets/$(basename "$model")" ]; then continue; fi
        inspect=$(try inspect "$model" "$model" | awk 'NR == 2 { print $3 " of " $2 ", " $4 }')
        self=$(try query "$model" --self | told '^\([0-9]*\) pairs of triangles$' | commas)
        sweep=$(try sweep "$model" --fps 10 | told '^Triangles touch in \(.*\) frames\. .*')
        export=$(try export "$model" --mesh all --output "$scratch/out.glb" | told '.* triangles, \(.*\) of them touch.*')
        rm -f "$scratch/scene.json"
        try scene "$model#all" "$model#all" --node-transforms --place 0,0,0 --place turn-y=10..90 --frames 9 --output "$scratch/scene.json"
        run=$(try run "$scratch/scene.json" | told '^triangle pairs *\([0-9]*\) over all frames$' | commas)
        motion=$(try motion "$scratch/scene.json" | told '^steps: 8, .* first contacts: \(.*\)$' | commas)
        verify=$("$lab" verify "$model" --frames 10 2> /dev/null | told '^All \(.*\) answers agree with brute force\.$')
        code=0
        "$lab" bench "$model" --rounds 1 --every 200 --method hybrid > "$scratch/bench" 2> /dev/null || code=$?
        case $code in 0) bench=agrees ;; 1) bench=differs ;; *) bench=refused ;; esac
        echo "| \`$(basename "$model")\` | ${inspect:-refused} | ${self:-refused} | ${sweep:-0} | ${export:-refused} | ${run:-0} | ${motion:-0} | ${verify:-none} | $bench |"
    done

# Counts the instructions of some scenes for several build profiles, and the bytes of the program (needs valgrind).
instructions-profiles:
    #!/usr/bin/env bash
    set -euo pipefail
    count() {
        profile=$1
        folder="${CARGO_TARGET_DIR:-target}/profiles/${profile//[^a-z]/_}"
        env CARGO_TARGET_DIR="$folder" "${@:2}" cargo build --quiet --release -p morph_collision_testkit --bin morph-lab
        LAB="$folder/release/morph-lab" just instructions pass-through-20480 dolphins-564 heads-cheek |
            while read -r scene wanted millions; do echo "$profile $scene,$wanted $millions"; done
        echo "$profile size $(wc -c < "$folder/release/morph-lab")"
    }
    count "default"
    count "lto = fat" CARGO_PROFILE_RELEASE_LTO=fat
    count "lto = fat, codegen-units = 1, panic = abort" \
        CARGO_PROFILE_RELEASE_LTO=fat CARGO_PROFILE_RELEASE_CODEGEN_UNITS=1 CARGO_PROFILE_RELEASE_PANIC=abort

# Counts all of these for the pages of docs/measurements. The machine may be busy with other work (needs valgrind).
instructions-report:
    #!/usr/bin/env bash
    set -euo pipefail
    just instructions-rivals | just report --counts instructions
    just instructions-motion | just report --counts instructions_motion
    just instructions-profiles | just report --counts instructions_profiles

# Compares the tests of moving features with exact arithmetic: COUNT random motions (a million by default) of every kind, and recorded ones.
motions COUNT="1000000" SEED="7":
    {{lab}} motions {{COUNT}} {{SEED}}

# Fails if a scene's queries take over 5 % more instructions than recorded in instructions.txt. Skipped if the processor has no AVX2.
instructions-check: release
    #!/usr/bin/env bash
    set -euo pipefail
    kernel=$("${CARGO_TARGET_DIR:-target}/release/morph-lab" frames)
    if [ "$kernel" != avx2 ]; then echo "skipped: the counts are those of avx2, not of $kernel"; exit; fi
    recorded=crates/morph_collision_testkit/instructions.txt
    just instructions $(awk '$2 == "all" { print $1 }' "$recorded") | awk -v recorded="$recorded" '
        BEGIN { while ((getline < recorded) > 0) { before[$1 " " $2] = $3; rows++ } }
        { ratio = $3 / before[$1 " " $2]; failed += ratio > 1.05 || $3 == 0; printf "%s  %.3f of %s\n", $0, ratio, before[$1 " " $2] }
        END { if (failed || NR != rows) exit 1 }' || { echo "slower than $recorded says, or not all of it was counted; record it anew if that is meant"; exit 1; }

# The same for what a frame of a crowd costs the plugin: the rows of examples/report/crowds/instructions.txt, in thousands.
crowds-check: release
    #!/usr/bin/env bash
    set -euo pipefail
    kernel=$("${CARGO_TARGET_DIR:-target}/release/morph-lab" frames)
    if [ "$kernel" != avx2 ]; then echo "skipped: the counts are those of avx2, not of $kernel"; exit; fi
    recorded=examples/report/crowds/instructions.txt
    count() { just instructions-run $1 $2 | awk -v row="$1 $2" '/ all systems$/ { print row, $1 }'; }
    export -f count
    awk '{ print $1, $2 }' "$recorded" | xargs -P "$(nproc)" -L 1 bash -c 'count $0 $1' | awk -v recorded="$recorded" '
        BEGIN { while ((getline < recorded) > 0) { before[$1 " " $2] = $3; rows++ } }
        { ratio = $3 / before[$1 " " $2]; failed += ratio > 1.05 || $3 == 0; printf "%s  %.3f of %s\n", $0, ratio, before[$1 " " $2] }
        END { if (failed || NR != rows) exit 1 }' || { echo "slower than $recorded says, or not all of it was counted; record it anew if that is meant"; exit 1; }

# Compares self-queries with and without certificates in COUNT random expressions of every mesh of MODELS.
certificates COUNT="1000" *MODELS="assets/dolphin_564.glb assets/mh_character_low.glb assets/mh_head_eyes_teeth_arkit52.glb":
    {{lab}} certificates {{COUNT}} {{MODELS}}

# Checks nearly degenerate pairs of triangles against exact arithmetic: a million of them by default.
triangles *ARGS:
    {{lab}} triangles {{ARGS}}

# Line coverage of the folders exact and pose by the tests of the core and the test kit (needs cargo install cargo-llvm-cov).
coverage:
    cargo llvm-cov --summary-only -p morph_collision -p morph_collision_testkit 2> /dev/null | grep -E "^(Filename|(morph_collision/src/)?(exact|pose)/)"
