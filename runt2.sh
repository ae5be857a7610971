. /tmp/w4env.sh; export PYTHONPATH=/tmp/t4/v_t/src ASPERITY_KERNELS=/tmp/t4/kern_t SHIFT=0; cd /tmp/t4
for q in "$@"; do IFS=, read N0 N1 KN <<< "$q"; export N0 N1 KN; python big.py q_$q 1 edges 2>/dev/null; done
