# Build: CMake presets (CMakePresets.json) under build/PRESET. Sourced by the launcher.
# shellcheck shell=bash

readonly solver_target=wingcrack-solver
readonly ranks_target=wingcrack-ranks
readonly verification_target=verification-programs
readonly solver=$root/build/release/fortran/app/$solver_target
readonly ranks_solver=$root/build/release/fortran/app/$ranks_target

# Exit status of a build that fails. Who only wants to run lacks a program; to a developer it is
# the result.
build_failure=$exit_environment

version() {
    local line
    while IFS= read -r line; do
        if [[ $line =~ ^project\(.*\ VERSION\ ([0-9.]+) ]]; then
            printf 'wingcrack %s\n' "${BASH_REMATCH[1]}"
            return
        fi
    done <"$root/CMakeLists.txt"
}

# build_is_current PRESET TARGET: nothing that the build reads is newer than its record, and the
# tree has not moved since (library paths) nor the processor changed (whose instructions are used).
build_is_current() {
    local record_file=$root/build/$1/built-$2 record='' place strictness also=()
    if [[ $2 != "$solver_target" && $2 != "$ranks_target" ]]; then
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

# Set place: where the tree lies, the processor's name and what becomes of warnings, a line each.
find_place() {
    local line
    place=$root$'\n'
    while IFS= read -r line; do
        if [[ $line == 'model name'* ]]; then
            place+=${line#*: }$'\n'
            break
        fi
    done </proc/cpuinfo
    find_strictness
    place+="warnings are errors: $strictness"$'\n'
}

# Set strictness: in CI, warnings of the compilers are errors.
find_strictness() {
    strictness=OFF
    if [[ ${CI:-} == true ]]; then strictness=ON; fi
}

# configure PRESET: let CMake write the build files.
configure() {
    local directory=$root/build/$1 place strictness old_place=''
    find_place
    if [[ -r $directory/place ]]; then IFS= read -r -d '' old_place <"$directory/place"; fi
    if [[ $old_place != "$place" ]]; then rm -rf "$directory"; fi
    mkdir -p "$directory" && printf '%s' "$place" >"$directory/place" ||
        fail "$exit_environment" "$directory cannot be written"
    from_root logged cmake --preset "$1" "-DWINGCRACK_WARNINGS_ARE_ERRORS=$strictness" ||
        fail_with_log "configuring the build, $1, failed" "$build_failure"
}

# compile PRESET TARGET...
compile() {
    say "building ${*:2}, $1 (log: $setup_log)"
    from_root logged cmake --build --preset "$1" --target "${@:2}" ||
        fail_with_log "building ${*:2} failed" "$build_failure"
}

# build PRESET TARGET, unless it is current.
build() {
    local directory=$root/build/$1 record=$root/build/$1/built-$2
    if build_is_current "$1" "$2"; then return; fi
    # The record is as old as the start of the build: what changes meanwhile is newer.
    configure "$1"
    cp "$directory/place" "$directory/building-$2"
    compile "$1" "$2"
    mv "$directory/building-$2" "$record"
}

# build_in_sight PRESET: everything, with the compilers' words on the terminal.
build_in_sight() {
    configure "$1"
    from_root cmake --build --preset "$1" || fail 1 "building, $1, failed"
}

# CMake reads presets where it is called.
from_root() (
    cd "$root" && "$@"
)
