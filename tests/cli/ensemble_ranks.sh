#!/usr/bin/env bash
# An ensemble over the ranks of mpirun is the same as in one process, byte for byte.
#   ensemble_ranks.sh PROGRAM MPIRUN
set -euo pipefail

program=$1 mpirun=$2
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
ensemble=(ensemble --vary material.friction_coefficient=0.2:0.5 --runs 4 --set solver.target_particle_count=200
          --set solver.end_time_s=4 --quiet)
"$program" "${ensemble[@]}" -o "$folder/one"
# What Open MPI keeps until its ranks end is not a leak of ours; the program without it, above, is looked at.
export ASAN_OPTIONS=${ASAN_OPTIONS:+$ASAN_OPTIONS:}detect_leaks=0
"$mpirun" -n 3 "$program" "${ensemble[@]}" -o "$folder/three"
for file in probability_depth_0.1m.tif peak_depth_p95.tif buildings.csv distributions.csv statistics.json; do
    cmp "$folder/one/$file" "$folder/three/$file"
done
# So is one with runs of the depth-averaged model beside it.
fast=("${ensemble[@]}" --fast-runs 12 --set solver.grid_cell_m=5)
"$program" "${fast[@]}" -o "$folder/fast_one"
"$mpirun" -n 2 "$program" "${fast[@]}" -o "$folder/fast_two"
for file in probability_depth_0.1m.tif peak_depth_p95.tif buildings.csv distributions.csv statistics.json two_models.csv; do
    cmp "$folder/fast_one/$file" "$folder/fast_two/$file"
done
(($(find "$folder/fast_two/fast/runs" -name '*.run' | wc -l) == 12))
# So is the design of a barrier: each rank makes its share of the runs of a height, and all go on to the same next height.
design=(design "$(dirname "$0")/../../examples/barrier/scene.toml" --barrier barrier
        --vary material.friction_coefficient=0.15:0.25 --runs 3 --min-height 1 --max-height 7 --height-step 2
        --set solver.model=depth_averaged --set solver.grid_cell_m=5 --set solver.end_time_s=30 --quiet)
"$program" "${design[@]}" -o "$folder/design_one"
"$mpirun" -n 2 "$program" "${design[@]}" -o "$folder/design_two"
for file in heights.csv runs.csv loads.csv; do
    cmp "$folder/design_one/$file" "$folder/design_two/$file"
done
# All ranks stop at bad input, and one of them says why.
status=0
"$mpirun" -n 2 "$program" ensemble --vary material.viscosity=0.2:0.1 -o "$folder/bad" 2>"$folder/error" || status=$?
((status == 2))
(($(grep -c "talus: error:" "$folder/error") == 1))
