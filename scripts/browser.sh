#!/usr/bin/env bash
# Install a headless Chromium for the tests that look at pages, where that is possible: as root on
# Debian or Ubuntu. Where it is not, say so and succeed; those tests are then skipped.
set -euo pipefail

say() { printf 'browser: %s\n' "$*" >&2; }

# A browser that really runs: on Ubuntu `chromium-browser` may be a stub that asks for snap.
usable() {
    command -v "$1" >/dev/null && timeout 60 "$1" --headless --no-sandbox --version >/dev/null 2>&1
}

for candidate in ${VASO_CHROMIUM:-chromium chromium-browser google-chrome}; do
    if usable "$candidate"; then exit 0; fi
done

if ! command -v apt-get >/dev/null; then
    say "no browser here and no apt-get to install one: tests of the pages are skipped"
elif [ "$(id -u)" != 0 ]; then
    say "no browser here; install one (apt-get install chromium), else tests of the pages are skipped"
else
    say "installing Chromium"
    export DEBIAN_FRONTEND=noninteractive
    if { apt-get update && apt-get install --yes --no-install-recommends chromium; } >/dev/null 2>&1 &&
        usable chromium; then
        say "$(chromium --version 2>/dev/null | tail -1)"
    else
        say "Chromium cannot be installed: tests of the pages are skipped"
    fi
fi
