#!/bin/sh
# SPDX-License-Identifier: MIT
# One task of a Slurm job array: bakes one asset of the Makefile. One core each; the machines share the folder.
#
#     sbatch --array=1-$(make -s list | wc -l) slurm-array.sh        # again after failures: only those are baked
#     make -s list >names.txt; python3 report_merge.py --expect names.txt -o all.json baked/*.json
#
#SBATCH --cpus-per-task=1
set -eu

name=$(make -s list | sed -n "${SLURM_ARRAY_TASK_ID:?set by sbatch --array}p")
[ -n "$name" ] || { echo "slurm-array.sh: there is no asset number $SLURM_ARRAY_TASK_ID" >&2; exit 1; }
exec make "$name"
