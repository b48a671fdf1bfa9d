set terminal svg size 960,320 font "sans-serif,11" background "white"
set output "docs/convergence.svg"
set datafile separator ","
set logscale xy
set format y "10^{%L}"
set xlabel "ms, one thread"
set grid lc rgb "#dddddd"
set multiplot layout 1,3
array name[3] = ["hanging_cloth", "dam_break", "column"]
do for [k=1:3] {
    set title name[k] noenhanced
    set ylabel (k == 1 ? "objective gap" : "")
    file = sprintf("out/%s.csv", name[k])
    plot "< grep newton ".file using 3:4 with linespoints pt 7 ps 0.4 lc rgb "#2b6cb0" title "newton", \
         "< grep projective ".file using 3:4 with lines lw 2 lc rgb "#dd6b20" title "projective"
}
unset multiplot
