# In place of tools/setup.sh where wingcrack is installed (cmake/Install.cmake): nothing is installed
# or built from here, what is missing is named. Sourced by the launcher.
# shellcheck shell=bash
# shellcheck disable=SC2034,SC2154 # names of the launcher

# Where caches go, and the Python that has the packages.
readonly venv=${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/wingcrack
readonly venv_python=${WINGCRACK_PYTHON:-$(command -v python3)}
readonly share=$root/../../share/wingcrack

needed_modules=(click matplotlib numpy pandas)
needed_list=requirements.txt

case ${1:-} in
    run | check) needed_modules=() ;; # and figures say themselves what they lack
    verify | bench | test | build | format | lint | docs)
        fail "$exit_usage" "$1 needs the folder of the sources; installed are run, check, plot," \
            'analyse, view, new, import, network and study'
        ;;
esac

has_command() { command -v "$1" >/dev/null; }

prepare() {
    if [[ ! -x $solver ]]; then
        fail "$exit_environment" "the solver $solver is missing: install wingcrack anew"
    fi
}

prepare_study() { need requirements_study.txt dask distributed pyarrow pydantic scipy; }
prepare_water() { need requirements_water.txt iapws; }
prepare_maps() { need requirements_maps.txt shapely; }
prepare_ranks() { fail "$exit_usage" '--ranks needs the folder of the sources'; }

# need LIST MODULE...
need() {
    needed_list=$1
    needed_modules+=("${@:2}")
    prepare
}

# From here to the end of this call Python is used: it is there, and has the packages.
hold_python() {
    local missing
    if [[ ! -x $venv_python ]] && ! has_command "$venv_python"; then
        fail "$exit_environment" "there is no Python ${WINGCRACK_PYTHON:-python3}:" \
            'name one of 3.11 or newer by WINGCRACK_PYTHON'
    fi
    missing=$("$venv_python" -I - "${needed_modules[@]}" <<'PYTHON'
import importlib.util
import sys

missing = [name for name in sys.argv[1:] if importlib.util.find_spec(name) is None]
if sys.version_info < (3, 11):
    missing.insert(0, "Python 3.11")
print("lacks:", ", ".join(missing))
PYTHON
    )
    if [[ $missing != lacks:* ]]; then fail "$exit_environment" "$venv_python is no Python"; fi
    missing=${missing#lacks: }
    if [[ -n $missing ]]; then
        fail "$exit_environment" "$venv_python lacks $missing: install" \
            "$(cd -- "$share" && pwd -P)/$needed_list with its pip, or name another Python by" \
            'WINGCRACK_PYTHON'
    fi
}
