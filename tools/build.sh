# Build: CMake presets (CMakePresets.json) under build/PRESET. Sourced by the launcher.

readonly solver_target=wingcrack-solver
readonly verification_target=verification-programs
readonly solver=$root/build/release/fortran/app/wingcrack-solver

# build_is_current PRESET TARGET: nothing that the build reads is newer than its record, and the
# tree has not moved since (library paths) nor the processor changed (-march=native).
build_is_current() {
    local record_file=$root/build/$1/built-$2 record='' place also=()
    if [[ $2 != "$solver_target" ]]; then
        also=("$root/verification/CMakeLists.txt" "$root/verification/programs")
    fi
    if [[ ! -r $record_file ]]; then return 1; fi
    IFS= read -r -d '' record <"$record_file"
    find_place
    if [[ $record != "$place" ]]; then return 1; fi
    # Newer folders count too: that is how a removed file shows.
    [[ -z $(find "$root/CMakeLists.txt" "$root/CMakePresets.json" "$root/cmake" "$root/fortran" \
        "$root/cpp_mesh" "$venv_record" ${also[@]+"${also[@]}"} \
        -newer "$record_file" -print -quit) ]]
}

# Set place: where the tree lies and the processor's name, a line each.
find_place() {
    local line
    place=$root$'\n'
    while IFS= read -r line; do
        if [[ $line == 'model name'* ]]; then
            place+=${line#*: }$'\n'
            break
        fi
    done </proc/cpuinfo
}

# build PRESET TARGET, unless it is current.
build() {
    local preset=$1 target=$2
    local directory=$root/build/$preset place old_place=''
    if build_is_current "$preset" "$target"; then return; fi
    say "building $target, $preset (log: $setup_log)"
    find_place
    if [[ -r $directory/place ]]; then IFS= read -r -d '' old_place <"$directory/place"; fi
    if [[ $old_place != "$place" ]]; then rm -rf "$directory"; fi
    # The record is as old as the start of the build: what changes meanwhile is newer.
    mkdir -p "$directory" && printf '%s' "$place" >"$directory/place" &&
        cp "$directory/place" "$directory/building-$target" ||
        fail "$exit_environment" "$directory cannot be written"
    { from_root cmake --preset "$preset" &&
        from_root cmake --build --preset "$preset" --target "$target"; } ||
        fail_with_log "building $target failed"
    mv "$directory/building-$target" "$directory/built-$target"
}

# CMake reads presets where it is called.
from_root() (
    cd "$root" && logged "$@"
)
