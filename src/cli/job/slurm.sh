#!/bin/bash
# A Slurm array job of @FRAMES@ frames of @TITLE@, @CHUNK@ a task, printed by darkness @VERSION@.
# Make the table once, on a disk that all nodes share, then submit. Relative paths count from the folder of the
# submission:
#   darkness table @TABLE_NAME@ -o @TABLE@
#   sbatch @FILE@
# Or make the table in a job too, with the frames after it:
#   sbatch --dependency=afterok:"$(sbatch --parsable --array=0 @FILE@ table)" @FILE@
# Submitted again, it renders what is missing. The nodes need `darkness` on their PATH; sbatch passes its own PATH on.
# To run at most 8 tasks at once: sbatch --array=0-@LAST_TASK@%8 @FILE@
#SBATCH --job-name=@NAME@
# What your cluster may ask for: fill in, and remove one # of each.
##SBATCH --partition=PARTITION
##SBATCH --time=HH:MM:SS
##SBATCH --mem=4G
#SBATCH --array=0-@LAST_TASK@
#SBATCH --output=darkness-%A_%a.log
#SBATCH --open-mode=append
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=2
#SBATCH --requeue
#SBATCH --signal=B:TERM@60

SCENE=@SCENE@@SKY@
TABLE=@TABLE@
OUT=@OUT@
# SLURM_ARRAY_TASK_MAX is the array's last index, not the last frame.
FIRST=@FIRST@
LAST=@LAST@
CHUNK=@CHUNK@

# With `exec`, Slurm's SIGTERM (60 s before the time limit, and on scancel) reaches darkness, which finishes the frames
# that it has begun.
if [ "${1-}" = table ]; then
  exec darkness table @TABLE_NAME@ -o "$TABLE"
fi
FIRST_OF_TASK=$((FIRST + SLURM_ARRAY_TASK_ID * CHUNK))
LAST_OF_TASK=$((FIRST_OF_TASK + CHUNK - 1))
if [ "$LAST_OF_TASK" -gt "$LAST" ]; then LAST_OF_TASK=$LAST; fi
exec darkness render "$SCENE" --frames="$FIRST_OF_TASK-$LAST_OF_TASK" --table "$TABLE" --require-table \
  --threads "${SLURM_CPUS_PER_TASK:-1}" -o "$OUT"
