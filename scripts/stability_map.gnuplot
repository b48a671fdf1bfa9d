set terminal svg size 960,560 font "sans-serif,12" background "white"
set output "docs/results/stability.svg"
set datafile separator ","
set logscale cb
set cbrange [0.01:1e4]
set format cb "10^{%L}"
set palette defined (0 "#2b6cb0", 0.35 "#bee3f8", 0.5 "#fefcbf", 1 "#9b2c2c")
set xtics ("1e-4" -4, "1e-3" -3, "0.01" -2, "0.1" -1, "1" 0) font ",10"
set ytics 2
set format y "10^{%.0f}"
set xrange [-4.5:0.5]
set yrange [-1:13]
unset key
set multiplot layout 2,3 title "mean step residual |grad E| / |M g| of twenty steps; a step counts as solved below 0.1; x: failed"
do for [step in "projective newton"] {
    do for [scene in "fluid cloth coupled"] {
        set title scene.", ".step noenhanced
        set xlabel "h, s"
        set ylabel scene eq "cloth" ? "stretching stiffness, N/m" : "weight w of the fluid, N/m"
        rows = sprintf("< grep '^%s,%s,' bench/stability.csv", scene, step)
        plot rows using (log10($3)):(log10($4)):($6 > 0.01 ? $6 : 0.01) with image, \
             rows using (log10($3)):(stringcolumn(5) eq "good" ? 1/0 : log10($4)) with points pt 2 lc rgb "black"
    }
}
unset multiplot
