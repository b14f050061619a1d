#!/bin/sh
# For the time limit of run.sh.
sleep 1000
