# Wants target, the SVG's path, and table, the CSV file of the heavy elastica.
set terminal svg size 960,400 font "sans-serif,11" background "white"
set output target
set datafile separator ","
set grid lc rgb "#dddddd"
rows(segments, irregular) = sprintf("< awk -F, '$3 == %s && $4 == 1 && $5 == %d' %s", segments, irregular, table)
set multiplot layout 1,2
set logscale xy
set xlabel "Gamma = w L^3 / B"

set title "Heavy elastica: drop over reach"
set ylabel "H / W"
set key top left Left reverse
most = system("awk -F, 'NR > 1 && $4 == 1 && $3 > m { m = $3 } END { print m }' ".table)
plot rows(most, 0) using 1:2 with lines lw 2 lc rgb "black" title "exact", \
     rows(most, 0) using 1:6 with points pt 6 lc rgb "#2b6cb0" title most." segments, regular", \
     rows(most, 1) using 1:6 with points pt 1 lc rgb "#dd6b20" title "irregular"

set title "Deviation of H / W"
set ylabel "%"
set yrange [1e-3:100]
set key bottom right
segments = system("awk -F, 'NR > 1 && $4 == 1 { print $3 }' ".table." | sort -nu")
plot for [k=1:words(segments)] rows(word(segments, k), 0) using 1:(100*abs($6/$2-1)) \
         with linespoints pt 6 ps 0.5 dt 4-k lc rgb "#2b6cb0" title word(segments, k).", regular", \
     for [k=1:words(segments)] rows(word(segments, k), 1) using 1:(100*abs($6/$2-1)) \
         with linespoints pt 1 ps 0.5 dt 4-k lc rgb "#dd6b20" title word(segments, k).", irregular"
unset multiplot
