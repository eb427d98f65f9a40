# Set-up: the system packages and the Python environment. Sourced by the launcher.
# shellcheck shell=bash
# The checks use nothing but the shell's own tests, so that a call with everything in place costs
# a few milliseconds; only when something is missing do programs start.

readonly venv=$root/.venv
readonly venv_python=$venv/bin/python
readonly venv_record=$venv/wingcrack-requirements
readonly setup_log=$root/build/setup.log
readonly setup_lock=$root/build/setup.lock
# How long a call waits: for calls that use .venv, which may go on for good, and for a set-up [s].
readonly patience=${WINGCRACK_WAIT:-60} long_patience=1800
# The file that lets Python in .venv find the packages of post/.
readonly path_file=wingcrack.pth

# The lists of packages that the command takes.
package_lists=("$root/tools/system_packages.txt")
requirement_lists=("$root/requirements.txt")

# prepare [TARGET]: see to the environment and, if a build target is named, to the release build.
prepare() {
    local target=${1:-}
    find_missing_packages
    if ((${#missing_packages[@]} == 0)) && python_is_ready; then
        if [[ -z $target ]] || build_is_current release "$target"; then return; fi
    fi
    understand
    with_lock set_up
    if [[ -n $target ]]; then with_lock build release "$target"; fi
}

# prepare_developer: see to the environment with the tools of a developer, who tests studies and
# the documentation too.
prepare_developer() {
    requirement_lists+=("$root/requirements_developer.txt" "$root/requirements_study.txt"
        "$root/requirements_water.txt" "$root/requirements_maps.txt" "$root/requirements_maps_gis.txt" "$root/requirements_docs.txt")
    prepare
}

# prepare_tests: see to what optional tests take, beside the rest: with WINGCRACK_ALL_TESTS=1 to all of
# it, with CI=true to what is small, as far as it can be had. Tests whose needs are not met are skipped.
prepare_tests() {
    package_lists+=("$root/tools/system_packages_tests.txt" "$root/tools/system_packages_ranks.txt")
    if [[ ${WINGCRACK_ALL_TESTS:-0} != 0 ]]; then
        package_lists+=("$root/tools/system_packages_browser.txt")
        requirement_lists+=("$root/requirements_browser.txt")
        prepare
    elif [[ ${CI:-} == true ]]; then
        (prepare) || say 'going on without what optional tests take'
    fi
}

# prepare_ranks: see to what takes MPI, beside the rest.
prepare_ranks() {
    package_lists+=("$root/tools/system_packages_ranks.txt")
    prepare "$ranks_target"
}

# prepare_study: see to what studies take, beside the rest.
prepare_study() {
    requirement_lists+=("$root/requirements_study.txt")
    prepare "$solver_target"
}

# prepare_water: see to what properties of water take, as well.
prepare_water() {
    requirement_lists+=("$root/requirements_water.txt")
    prepare "$solver_target"
}

# prepare_maps ARGUMENT...: see to what fracture maps and random networks take, in addition to the rest; what
# reads files of geographic information systems comes with the first of them, or with --crs.
prepare_maps() {
    requirement_lists+=("$root/requirements_maps.txt")
    local argument
    for argument; do
        case ${argument,,} in
            *.shp | *.gpkg | *.dxf | *.fgb | *.gml | *.kml | --crs | --crs=*)
                requirement_lists+=("$root/requirements_maps_gis.txt")
                break
                ;;
        esac
    done
    prepare "$solver_target"
}

# prepare_docs: see to what the site takes, beside the rest; the gallery and the Python pages ask the
# solver.
prepare_docs() {
    requirement_lists+=("$root/requirements_docs.txt")
    prepare "$solver_target"
}

# with_lock COMMAND...: one call at a time does such work; the others wait, and find it done.
with_lock() {
    local lock
    { mkdir -p "$root/build" && exec {lock}>"$setup_lock"; } ||
        fail "$exit_environment" "the set-up needs to write to $root/build"
    take_lock "$lock" "$setup_lock" "$long_patience" 'another call to finish the set-up'
    trap - TERM # long work is left at once
    "$@"
    end_on_signals
    exec {lock}>&-
}

# take_lock HANDLE FILE SECONDS WHAT [--shared]: wait for a lock, not for good; say for what, and
# who has it. Where a file system knows no locks there is nothing to wait for.
take_lock() {
    if flock ${5:+"$5"} --nonblock "$1" 2>/dev/null; then return; fi
    say "waiting for $4, $3 s at most: $(users_of "$2")"
    local left
    for ((left = $3; left > 0; left--)); do # a second each, so that signals are heeded
        flock ${5:+"$5"} --conflict-exit-code 75 --timeout 1 "$1" 2>/dev/null
        if (($? != 75)); then return; fi
    done
    fail "$exit_environment" "waited $3 s for $4: let this come to its end, or end it, and call" \
        "again: $(users_of "$2")"
}

# users_of FILE: the calls that have it open, as "wingcrack view out/onset (process 123)"; where none
# is a call, the other processes.
users_of() {
    local process file words calls='' others=''
    for process in /proc/[0-9]*; do
        if [[ ${process##*/} == "$$" || ${process##*/} == "$BASHPID" ]]; then continue; fi
        for file in "$process"/fd/*; do
            if [[ ! $file -ef $1 ]]; then continue; fi
            mapfile -d '' -t words <"$process/cmdline"
            if [[ ${words[1]:-} == */wingcrack ]]; then words=(- "${words[@]}"); fi
            if [[ ${words[2]:-} == */wingcrack || ${words[2]:-} == */tools/start.py ]]; then
                calls+="; wingcrack ${words[*]:3} (process ${process##*/})"
            else
                others+="; ${words[*]} (process ${process##*/})"
            fi
            break
        done
    done 2>/dev/null
    if [[ -n $calls ]]; then others=$calls; fi
    printf '%s' "${others#; }"
}

set_up() {
    find_missing_packages
    python_is_ready || adopt_python || find_system_python
    if ((${#missing_packages[@]} == 0)) && python_is_ready; then return; fi
    if [[ ${WINGCRACK_NO_INSTALL:-0} != 0 ]]; then refuse_to_install; fi
    if ((${#missing_packages[@]} > 0)); then install_packages; fi
    if ! python_is_ready; then install_python; fi
}

# System packages --------------------------------------------------------------------------------

# Fill missing_packages with the lines of the lists whose probe fails, as "package|why".
find_missing_packages() {
    local list package how why
    missing_packages=()
    for list in "${package_lists[@]}"; do
        while IFS='|' read -r package how why; do
            if [[ -z $package || $package == '#'* ]]; then continue; fi
            # Unquoted on purpose: the words of `how` are the probe and what it looks for.
            # shellcheck disable=SC2086
            set -f && set -- $how && set +f
            if ! "has_$1" "$2"; then missing_packages+=("${package%% *}|${why# }"); fi
        done <"$list"
    done
}

has_command() { command -v "$1" >/dev/null; }

has_library() {
    local directory
    for directory in "/usr/lib/$HOSTTYPE-linux-gnu" /usr/lib64 /usr/lib /usr/local/lib; do
        file_exists "$directory" "$1" && return
    done
    return 1
}

has_header() { file_exists /usr/include "$1" || file_exists /usr/local/include "$1"; }

# file_exists DIRECTORY PATTERN: a plain name is one look, a wildcard one reading of the directory.
file_exists() {
    if [[ $2 == *'*'* ]]; then
        compgen -G "$1/$2" >/dev/null
    else
        [[ -e $1/$2 ]]
    fi
}

install_packages() {
    local entry names
    say 'these system packages are missing:'
    for entry in "${missing_packages[@]}"; do
        printf '  %-22s %s\n' "${entry%%|*}" "${entry#*|}" >&2
    done
    has_command apt-get || fail "$exit_environment" 'there is no apt here: install them by hand'
    local as_root=()
    if ((EUID != 0)); then
        has_command sudo || fail "$exit_environment" 'installing them takes root or sudo'
        as_root=(sudo)
    fi
    say "installing them with apt (log: $setup_log)"
    local apt=("${as_root[@]+"${as_root[@]}"}" env DEBIAN_FRONTEND=noninteractive
        apt-get -y -o DPkg::Lock::Timeout=300)
    if ! compgen -G '/var/lib/apt/lists/*_Packages*' >/dev/null; then update_lists; fi
    # Lists can be there and old: then the servers no longer have what they name.
    if ! { name_packages && install_named; }; then
        update_lists
        { name_packages && install_named; } || fail_with_log 'apt could not install the packages'
    fi
    find_missing_packages
    if ((${#missing_packages[@]} > 0)); then
        fail "$exit_environment" \
            "apt is done, and these are still missing: ${missing_packages[*]%%|*}"
    fi
}

update_lists() { logged "${apt[@]}" update || fail_with_log 'apt-get update failed'; }

install_named() { logged "${apt[@]}" install --no-install-recommends "${names[@]}"; }

# Fill names: package names with a wildcard become the newest name that apt has a package of. It knows
# more names than it has packages: of what others merely provide, or once depended on.
name_packages() {
    local entry package found name
    names=()
    for entry in "${missing_packages[@]}"; do
        package=${entry%%|*}
        if [[ $package == *'*' ]]; then
            found=$(apt-cache pkgnames "${package%'*'}" | sort --version-sort --reverse |
                while IFS= read -r name; do
                    if [[ -n $(apt-cache show "$name" 2>/dev/null </dev/null) ]]; then
                        printf '%s' "$name"
                        break
                    fi
                done)
            if [[ -z $found ]]; then
                printf 'apt offers no package %s\n' "$package" >>"$setup_log"
                return 1
            fi
            package=$found
        fi
        names+=("$package")
    done
}

# Python environment -----------------------------------------------------------------------------

# The record of a complete environment, one for each list: where the tree lay, the interpreter
# behind it, what was asked for. A tree that was moved, a system Python that was replaced or a
# changed list differ.
python_is_ready() {
    local list record interpreter requirements
    if [[ ! -x $venv_python ]]; then return 1; fi
    for list in "${requirement_lists[@]}"; do
        find_record "$list"
        if [[ ! -r $record_file ]]; then return 1; fi
        IFS= read -r -d '' record <"$record_file"
        interpreter=${record#*$'\n'}
        interpreter=${interpreter%%$'\n'*}
        IFS= read -r -d '' requirements <"$list"
        [[ $venv_python -ef $interpreter &&
            $record == "$root"$'\n'"$interpreter"$'\n'"$requirements" ]] || return 1
    done
    finds_packages
}

# Whether Python in .venv knows where the packages of post/ are.
finds_packages() {
    local file
    for file in "$venv"/lib/python3*/site-packages/"$path_file"; do
        if [[ -e $file ]]; then return; fi
    done
    return 1
}

# Set record_file: the record of a list, $venv_record for requirements.txt.
find_record() {
    record_file=${1##*/}
    record_file=$venv/wingcrack-${record_file%.txt}
}

record_python() {
    local interpreter list
    interpreter=$(readlink -f -- "$venv_python") || return
    add_packages || return
    for list in "${requirement_lists[@]}"; do
        find_record "$list"
        { printf '%s\n%s\n' "$root" "$interpreter" && cat "$list"; } >"$record_file" || return
    done
}

# Let whoever uses .venv import the packages of post/: one line, which Python reads as it starts.
add_packages() {
    local folder
    folder=$("$venv_python" -I -c 'import sysconfig; print(sysconfig.get_path("purelib"))') || return
    printf '%s/post\n' "$root" >"$folder/$path_file"
}

# The requirements that .venv does not hold, one per line, with the version that it holds instead;
# all of them if it cannot say.
missing_requirements() {
    "$venv_python" -I - "${requirement_lists[@]}" 2>/dev/null <<'PYTHON' ||
import fileinput
import importlib.metadata
import sys

for line in fileinput.input(sys.argv[1:], encoding="utf-8"):
    name, _, version = line.strip().partition("==")
    if not version:
        continue
    try:
        found = importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        found = None
    if found is None:
        print(line.strip())
    elif found != version:
        print(f"{line.strip()} (here is {found})")
PYTHON
        grep --no-filename '==' "${requirement_lists[@]}"
}

# A .venv that was made by hand, or moved with the tree, is good if it is complete.
adopt_python() { [[ -x $venv_python && -z $(missing_requirements) ]] && record_python; }

# Set system_python to an interpreter that is new enough, or leave it empty; add the packages that
# making .venv with it takes.
find_system_python() {
    local candidate why='makes the Python environment (.venv)'
    system_python=''
    for candidate in python3 python3.14 python3.13 python3.12 python3.11; do
        if is_new_enough "$candidate"; then
            system_python=$candidate
            if ! "$candidate" -c 'import ensurepip, venv' 2>/dev/null; then
                missing_packages+=("$candidate-venv|$why")
            fi
            return
        fi
    done
    if ! has_command python3; then
        missing_packages+=("python3|$why" "python3-venv|$why")
    fi
}

is_new_enough() { "$1" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; }

install_python() {
    if [[ -z $system_python ]] && is_new_enough python3; then system_python=python3; fi
    if [[ -z $system_python ]]; then fail "$exit_environment" "$(python_too_old)"; fi
    local list wanted=() has_pip=1
    "$venv_python" -I -c 'import pip' 2>/dev/null || has_pip=0
    # Packages that are added disturb nobody; any other change waits until nobody uses .venv.
    if ((!has_pip)) || [[ $(missing_requirements) == *'(here is '* ]]; then claim_python; fi
    say "installing Python packages into .venv (log: $setup_log)"
    for list in "${requirement_lists[@]}"; do
        find_record "$list"
        if [[ -n ${claim:-} ]]; then rm -f "$record_file"; fi
        wanted+=(--requirement "$list")
    done
    if ((!has_pip)); then
        logged "$system_python" -m venv --clear "$venv" ||
            fail_with_log 'making the Python environment .venv failed'
    fi
    # Python compiles a file when it is first imported; many never are.
    logged "$venv_python" -m pip install --no-compile --no-input --disable-pip-version-check "${wanted[@]}" ||
        fail_with_log 'installing the Python packages failed'
    record_python || fail "$exit_environment" "$venv cannot be written"
    if [[ -n ${claim:-} ]]; then exec {claim}>&- && unset claim; fi
}

# Whoever uses .venv shares a lock of its folder, which is there in a tree that cannot be written,
# too, and stays the same when the environment in it is made anew.

# From here to the end of this call no other one changes .venv.
hold_python() {
    exec {hold}<"$venv"
    take_lock "$hold" "$venv" "$long_patience" 'another call to finish its change of .venv' --shared
    python_is_ready || fail "$exit_environment" '.venv was changed by another call: try again'
}

# Wait until no other call uses .venv.
claim_python() {
    mkdir -p "$venv" && exec {claim}<"$venv" || fail "$exit_environment" "$venv cannot be written"
    take_lock "$claim" "$venv" "$patience" 'other calls that use .venv to finish, as it must change'
}

python_too_old() { printf 'Python 3.11 or newer is needed, and here is %s' "$(python3 --version)"; }

# Messages ---------------------------------------------------------------------------------------

refuse_to_install() {
    local entry requirement
    say 'missing, and WINGCRACK_NO_INSTALL forbids installing:'
    for entry in "${missing_packages[@]+"${missing_packages[@]}"}"; do
        printf '  system package %-22s %s\n' "${entry%%|*}" "${entry#*|}" >&2
    done
    if ! python_is_ready; then
        if [[ -z $system_python ]] && has_command python3; then
            printf '  %s\n' "$(python_too_old)" >&2
        fi
        while IFS= read -r requirement; do
            printf '  Python package %s (.venv)\n' "$requirement" >&2
        done < <(missing_requirements)
    fi
    fail "$exit_environment" 'the environment lacks what is named above'
}

# logged COMMAND...: keep its words in the log.
logged() {
    printf '\n$ %s\n' "$*" >>"$setup_log"
    "$@" >>"$setup_log" 2>&1 <&0
}

# fail_with_log MESSAGE [STATUS]
fail_with_log() {
    tail -n 25 "$setup_log" >&2
    fail "${2:-$exit_environment}" "$1; $setup_log has it all"
}
