# The fronts of trade with both integrators. out: where scripts/time_stepping.sh has put them.
set terminal svg size 900,380 font "sans-serif,12" background "white"
set output "docs/results/time-stepping.svg"
set datafile separator ","
set logscale xy
set grid lc rgb "#dddddd"
set xlabel "ms of one processor, for a frame"
set ylabel "largest error, %"
set key top right
set multiplot layout 1,2
front(dir, other) = sprintf("< awk -F, 'NR > 1 && $3 < 1 && $0 !~ /integrator=%s/ { print $1 \",\" $3 }' %s/trade.csv | sort -t, -g | awk -F, 'NR == 1 || $2 < least { least = $2; print }'", other, dir)
do for [scene in "hanging_cloth curtain"] {
    set title scene noenhanced
    plot front(out."/trade-".scene."-euler", "bdf2") using 1:(100*$2) with linespoints pt 7 lc rgb "#a0aec0" title "euler", \
         front(out."/trade-".scene."-bdf2", "euler") using 1:(100*$2) with linespoints pt 7 lc rgb "#2b6cb0" title "bdf2"
}
unset multiplot
