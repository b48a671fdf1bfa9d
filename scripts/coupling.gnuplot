# Wants target, the SVG's path, and out, the folder of the CSV files.
set terminal svg size 960,720 font "sans-serif,11" background "white"
set output target
set datafile separator ","
set grid lc rgb "#dddddd"
set multiplot layout 2,2

set title "Water at rest in a sheet: what the pins carry"
set xlabel "s"
set ylabel "over the weight"
set yrange [0.95:1.05]
spacings = system("awk -F, 'NR > 1 && !s[$1]++ { print $1 }' ".out."/basin.csv")
plot for [d in spacings] sprintf("< awk -F, '$1 == %s' %s/basin.csv", d, out) using 4:5 with lines \
         title sprintf("%g mm", 1000 * real(d)), 1.005 lc rgb "#bbbbbb" notitle, 0.995 lc rgb "#bbbbbb" notitle

set title "Lintearia: sheet between two bars"
set xlabel "m"
set ylabel "m"
set yrange [*:*]
set size ratio -1
set key top center
finest = system("awk -F, 'NR > 1 && (!m || $1 < m) { m = $1 } END { print m }' ".out."/lintearia.csv")
rows = sprintf("< awk -F, '$1 == %s { if ($2 != area) print \"\"; area = $2; print }' %s/lintearia.csv", finest, out)
plot rows using 3:4 with lines lw 2 lc rgb "black" title "exact", \
     rows using 5:6 with points pt 6 ps 0.5 lc rgb "#2b6cb0" title sprintf("%g mm", 1000 * real(finest))
set size noratio

set title "Elastic gate: displacement of the tip"
set xlabel "s"
set ylabel "mm"
set key inside bottom right
$experiment << EOD
0.040,12.5
0.080,34.0
0.119,44.0
0.161,46.4
0.200,44.2
0.240,43.0
0.281,41.2
0.321,40.0
0.360,37.4
EOD
runs = system("awk -F, '$6 == \"bdf2\" && !s[$1 $2 $3]++ { print $1 \":\" $2 \":\" $3 }' ".out."/gate.csv")
part(r, k) = system(sprintf("echo %s | cut -d: -f%d", r, k))
plot $experiment using 1:2 with points pt 7 lc rgb "black" title "Antoci et al. 2007", \
     for [r in runs] sprintf("< awk -F, '$6 == \"bdf2\" && $1 == %s && $2 == %s && $3 == %s' %s/gate.csv", part(r, 1), part(r, 2), part(r, 3), out) \
         using 4:(1000*$5) with lines title sprintf("%g mm, %g MPa", 1000 * real(part(r, 1)), 1e-6 * real(part(r, 2)))

set title "Free water and cloth: angular momentum"
set xlabel "h, ms"
set ylabel "drift"
set logscale xy
set key inside top left
plot for [c in "0 0.02 0.2"] sprintf("< awk -F, '$2 == %s' %s/momentum_angular.csv", c, out) using (1000*$1):3 \
         with linespoints title "viscosity ".c, 2.4e-4 * x lc rgb "#bbbbbb" title "first order"
unset multiplot
