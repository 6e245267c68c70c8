#!/bin/sh
# Runs the statistical tests with more samples and fresh random numbers; writes docs/proof.md.
#
#   LUMIFLOW_PROVE_SEED=N tests/prove.sh
#
# The seed is the time in seconds unless it is given. The proof's tests are those in the files that
# use tests/support/effort.rs. Each runs alone, so that its time is its own.
set -eu
cd -- "$(dirname -- "$0")/.."

export LUMIFLOW_PROVE=1 LUMIFLOW_PROVE_SEED="${LUMIFLOW_PROVE_SEED:-$(date +%s)}"
table=$(mktemp)
output=$(mktemp)
trap 'rm -f "$table" "$output"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

# Prints what the test binary says to these arguments.
tests() { cargo test --quiet --locked --test tests -- "$@"; }

cargo test --locked --test tests --no-run
modules=$(grep -l 'effort::' tests/*.rs | sed 's#tests/\(.*\)\.rs#\1::#')
# shellcheck disable=SC2086 # one filter a word
names=$(tests $modules --list --format terse | sed -n 's/: test$//p' | sort)
[ -n "$names" ] || { echo "no test uses tests/support/effort.rs" >&2; exit 1; }

failed=0
for name in $names; do
    if tests --exact "$name" >"$output" 2>&1; then
        result=passed
    else
        result=FAILED
        failed=$((failed + 1))
        cat "$output"
    fi
    # The last word of "test result: …; finished in 0.52s".
    seconds=$(awk '/^test result:/ { time = $NF } END { print time }' "$output")
    # shellcheck disable=SC2016 # backquotes of Markdown
    printf '| `%s` | %s | %s |\n' "$name" "$result" "${seconds:-?}" | tee -a "$table"
done

processor=$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo 2>/dev/null | head -n 1)
system=$(sed -n 's/^PRETTY_NAME="\(.*\)"/\1/p' /etc/os-release 2>/dev/null || uname -s)
mkdir -p docs
{
    echo "# Proof"
    echo
    echo "The statistical tests with sixteen times the samples of the suite, a level a hundred times as"
    echo "strict, and random numbers of their own. \`./x prove\` wrote this file; do not edit it."
    echo
    echo "- Date: $(date -u '+%Y-%m-%d %H:%M') UTC"
    echo "- Commit: $(git describe --always --dirty --abbrev=12 --exclude='*' 2>/dev/null || echo unknown)"
    echo "- Machine: ${processor:-unknown processor}, $(getconf _NPROCESSORS_ONLN) processors, $system, $(rustc --version)"
    echo "- Command: \`LUMIFLOW_PROVE_SEED=$LUMIFLOW_PROVE_SEED ./x prove\`"
    echo "- Result: $(echo "$names" | wc -l) tests, $failed failed"
    echo
    echo "| test | result | time |"
    echo "|---|---|---|"
    cat "$table"
} >docs/proof.md.new
mv docs/proof.md.new docs/proof.md
printf 'docs/proof.md is written: %s failed\n' "$failed"
[ "$failed" = 0 ]
