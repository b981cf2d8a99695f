#!/usr/bin/env bash
# Runs a fuzzer on a copy of its corpus, so that the tree stays as it is. Usage: run_fuzzer.sh FUZZER CORPUS LONGEST [_long]
# LONGEST is that of an input, in bytes. Ten seconds; with _long two, and with FROUDE_LONG=1 ten minutes. Exit code 77: there
# is no clang here.
set -euo pipefail
fuzzer=$1 corpus=$2 longest=$3 seconds=10
name=$(basename "$corpus")
if [ "${4:-}" = _long ]; then
  if [ "${FROUDE_LONG:-}" = 1 ]; then seconds=600; else seconds=2; fi
fi
if [ -z "${FROUDE_FUZZ_COMPILER:-}" ] || [[ $FROUDE_FUZZ_COMPILER == *-NOTFOUND ]]; then
  echo 'skipped: there is no clang++, which fuzzers need (Debian: clang, libclang-rt-14-dev)'
  exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp -r "$corpus" "$work/corpus"
# What ends a run is kept beside the fuzzer, to be run again alone: FUZZER FILE.
"$fuzzer" -seed=1 -max_total_time="$seconds" -max_len="$longest" -rss_limit_mb=1024 -timeout=20 \
  -dict="${0%/*}/$name.dict" -artifact_prefix="$fuzzer." -print_final_stats=1 "$work/corpus"
