set terminal svg size 960,600 font "sans-serif,11" background "white"
set output "docs/results/convergence.svg"
set datafile separator ","
set logscale xy
set format y "10^{%L}"
set grid lc rgb "#dddddd"
set key bottom left
set multiplot layout 2,3
array name[3] = ["hanging_cloth", "dam_break", "column"]
array column_of[3] = [8, 6, 6]
array label_of[3] = ["cloth error", "mean density error", "mean density error"]
do for [row=1:2] {
    do for [k=1:3] {
        set title row == 1 ? name[k] : "" noenhanced
        set xlabel row == 2 ? "ms, one thread" : ""
        set ylabel row == 1 ? "objective gap" : label_of[k]
        file = sprintf("out/%s.csv", name[k])
        y = row == 1 ? 4 : column_of[k]
        plot "< grep newton ".file using 3:y with linespoints pt 7 ps 0.4 lc rgb "#2b6cb0" title "newton", \
             "< grep projective ".file using 3:y with lines lw 2 lc rgb "#dd6b20" title "projective"
    }
}
unset multiplot
