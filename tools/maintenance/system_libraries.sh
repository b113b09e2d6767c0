#!/bin/sh
# Offscreen OpenGL for MuJoCo: nothing to do where libEGL with Mesa or libOSMesa is there, else installed as root,
# else the one line to run is printed.
set -eu
PATH="$PATH:/usr/sbin:/sbin"  # for ldconfig: Debian leaves these folders out of a user's PATH
has() { ldconfig -p 2>/dev/null | grep -q "$1"; }
if { has libEGL.so.1 && { has libEGL_mesa.so.0 || has libEGL_nvidia.so.0; }; } || has libOSMesa.so; then
    exit 0
fi
[ "$(uname -s)" = Linux ] || exit 0
line="apt-get install -y --no-install-recommends libegl1 libegl-mesa0 libgl1-mesa-dri"
if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    echo "== installing Mesa's EGL for offscreen rendering"
    apt-get update -qq
    DEBIAN_FRONTEND=noninteractive $line
else
    echo "Offscreen rendering needs Mesa's EGL. Run this once, then again what you ran: sudo $line" >&2
    exit 1
fi
