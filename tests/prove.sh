#!/bin/sh
# Runs the statistical tests with more samples and fresh random numbers; writes docs/proof.md.
#
#   LUMIFLOW_PROVE_SEED=N tests/prove.sh
#
# The seed is the time in seconds unless it is given. The proof's tests are those in the files that
# use tests/support/effort.rs. Each runs alone, so that its time is its own.
#
# Two processors share the work where the same call is made twice, the second time with
# LUMIFLOW_PROVE_FROM=end: it begins with the last test, and either one leaves out what the other
# has done.
#
# A proof that was interrupted goes on where it was when it is asked for with the same seed. What has
# passed counts as long as neither the program nor the test has changed since: target/proof/ holds a
# file for each test, named after the test and after the sources that it was made of.
set -eu
cd -- "$(dirname -- "$0")/.."

export LUMIFLOW_PROVE=1 LUMIFLOW_PROVE_SEED="${LUMIFLOW_PROVE_SEED:-$(date +%s)}"
commit=$(git describe --always --dirty --abbrev=12 --exclude='*' 2>/dev/null || echo unknown)
kept="${CARGO_TARGET_DIR:-target}/proof/$LUMIFLOW_PROVE_SEED"
# Only a commit says what was proven.
case "$commit" in
*dirty | unknown) rm -rf "$kept" ;;
esac
mkdir -p "$kept"

# record NAME: the file of a test.
record() {
    module=${1%%::*}
    sources=$(for path in src ffi scenes Cargo.toml Cargo.lock tests/support "tests/$module.rs" "tests/$module"; do
        git rev-parse --verify --quiet "HEAD:$path" || true
    done | git hash-object --stdin | cut -c 1-12)
    printf '%s/%s-%s' "$kept" "$1" "$sources"
}

output=$(mktemp)
trap 'rm -f "$output"' EXIT
stopped() {
    echo "interrupted; go on with: LUMIFLOW_PROVE_SEED=$LUMIFLOW_PROVE_SEED ./x prove" >&2
    exit "$1"
}
trap 'stopped 130' INT
trap 'stopped 143' TERM

# Prints what the test binary says to these arguments.
tests() { cargo test --quiet --locked --test tests -- "$@"; }

cargo test --locked --test tests --no-run
modules=$(grep -l 'effort::' tests/*.rs | sed 's#tests/\(.*\)\.rs#\1::#')
# shellcheck disable=SC2086 # one filter a word
names=$(tests $modules --list --format terse | sed -n 's/: test$//p' | sort)
order=cat
[ "${LUMIFLOW_PROVE_FROM:-start}" != end ] || order=tac
[ -n "$names" ] || { echo "no test uses tests/support/effort.rs" >&2; exit 1; }

for name in $(echo "$names" | $order); do
    record=$(record "$name")
    # One that has failed runs again.
    if grep -qF '| passed |' "$record" 2>/dev/null; then
        continue
    fi
    if tests --exact "$name" >"$output" 2>&1; then
        result=passed
    else
        result=FAILED
        cat "$output"
    fi
    # The last word of "test result: …; finished in 0.52s".
    seconds=$(awk '/^test result:/ { time = $NF } END { print time }' "$output")
    # shellcheck disable=SC2016 # backquotes of Markdown
    printf '| `%s` | %s | %s |\n' "$name" "$result" "${seconds:-?}" | tee "$record"
done

results=$(for name in $names; do cat "$(record "$name")"; done)
failed=$(echo "$results" | grep -cF '| FAILED |' || true)

processor=$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo 2>/dev/null | head -n 1)
system=$(sed -n 's/^PRETTY_NAME="\(.*\)"/\1/p' /etc/os-release 2>/dev/null || uname -s)
mkdir -p docs
{
    echo "# Proof"
    echo
    echo "The statistical tests with sixteen times the samples of the suite, a level a hundred times as"
    echo "strict, and random numbers of their own. A test that has passed counts as long as neither the program"
    echo "nor the test has changed. \`./x prove\` wrote this file; do not edit it."
    echo
    echo "- Date: $(date -u '+%Y-%m-%d %H:%M') UTC"
    echo "- Commit: $commit"
    echo "- Machine: ${processor:-unknown processor}, $(getconf _NPROCESSORS_ONLN) processors, $system, $(rustc --version)"
    echo "- Command: \`LUMIFLOW_PROVE_SEED=$LUMIFLOW_PROVE_SEED ./x prove\`"
    echo "- Result: $(echo "$names" | wc -l) tests, $failed failed"
    echo
    echo "| test | result | time |"
    echo "|---|---|---|"
    echo "$results"
} >docs/proof.md.new
mv docs/proof.md.new docs/proof.md
printf 'docs/proof.md is written: %s failed\n' "$failed"
[ "$failed" = 0 ]
