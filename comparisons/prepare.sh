# Sourced by comparisons/run.sh and tests/run.sh: the packages that the build needs, and installing them.
#
# SOFTFINGER_INSTALL=0 turns installing off: what is missing is then named, and the script stops.

softfinger_packages() { # analytic|fem, run|test
  echo g++ cmake ninja-build libeigen3-dev libcli11-dev libtomlplusplus-dev nlohmann-json3-dev libfmt-dev libfcl-dev libpng-dev zlib1g-dev libtinyxml2-dev
  command -v npm >/dev/null || echo npm
  # clang compiles the project, and with the others C++ to WebAssembly, for the page of `softfinger explore`.
  echo clang lld libc++-14-dev-wasm32 libc++abi-14-dev-wasm32 wasi-libc libclang-rt-14-dev-wasm32
  if [ "$1" = fem ]; then echo libdeal.ii-dev libgmsh-dev libnanoflann-dev libsuitesparse-dev libopenblas-dev libopenmpi-dev; fi
  if [ "$2" = test ]; then
    echo clang-format libgtest-dev librapidcheck-dev libbenchmark-dev libmujoco-dev libsdformat-dev liburdfdom-dev libassimp-dev libbullet-dev libode-dev libdart-dev
    echo pybind11-dev python3-dev python3-numpy python3-matplotlib python3-pip python3-venv python3-setuptools python3-wheel dpkg-dev doxygen
    if [ "$1" = fem ]; then echo openmpi-bin; fi
    command -v chromium >/dev/null || echo chromium
    # It only saves time: nothing stops where it is missing.
    [ "${SOFTFINGER_INSTALL:-1}" = 0 ] || echo ccache
  fi
}

# clang compiles this project in two thirds to four fifths of GCC's time and with half its memory, to programs as fast
# within 15 %. A build folder stays with the compiler that it began with; CXX in the environment names another one.
softfinger_configure() { # arguments of cmake
  CXX="${CXX:-clang++}" cmake "$@"
}

# What has been compiled once is not compiled again: by the test that builds the wheel, in a folder of its
# own, or after the build folder was removed. Build folders that were configured before stay as they are.
softfinger_use_ccache() {
  command -v ccache >/dev/null && mkdir -p "$(ccache --get-config cache_dir)" 2>/dev/null || return 0
  export CMAKE_CXX_COMPILER_LAUNCHER="${CMAKE_CXX_COMPILER_LAUNCHER-ccache}"
  # Sources below this folder are the same whatever their folder is called.
  export CCACHE_BASEDIR="${CCACHE_BASEDIR-$PWD}"
  # For precompiled headers, as its manual says. No source asks for the time of its compilation.
  export CCACHE_SLOPPINESS="${CCACHE_SLOPPINESS-pch_defines,time_macros,include_file_mtime,include_file_ctime}"
}

softfinger_prepare() { # analytic|fem, run|test
  local missing=() package root=()
  for package in $(softfinger_packages "$1" "$2"); do
    # A tool that is already there under another package's name is good enough.
    case $package in
      g++|cmake) command -v "$package" >/dev/null && continue ;;
      ninja-build) command -v ninja >/dev/null && continue ;;
    esac
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  if [ "${SOFTFINGER_INSTALL:-1}" = 0 ]; then
    echo "missing packages (SOFTFINGER_INSTALL=0, so nothing was installed): ${missing[*]}" >&2
    return 1
  fi
  [ "$(id -u)" -eq 0 ] || root=(sudo)
  echo "installing: ${missing[*]}" >&2
  export DEBIAN_FRONTEND=noninteractive
  "${root[@]}" apt-get update -qq
  "${root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}
