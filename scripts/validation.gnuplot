# Wants target, the SVG's path, and deep, the DEPTHxWIDTH of the tank.
set terminal svg size 960,720 font "sans-serif,11" background "white"
set output target
set datafile separator ","
set grid lc rgb "#dddddd"
out = "out/validation/"
files(pattern) = system("ls -v ".out.pattern)
part(path, n) = word(system("basename ".path." .csv | tr _ ' '"), n)
set multiplot layout 2,2

set title "Dam break: front"
set xlabel "T = t sqrt(2 g / a)"
set ylabel "Z = front / a"
set xrange [0:4]
set yrange [1:4.2]
set key top left Left reverse noenhanced
plot "bench/martin_moyce_1.125in.csv" with points pt 6 lc rgb "black" title "Martin & Moyce, a = 1.125 in", \
     "bench/martin_moyce_2.25in.csv" with points pt 4 lc rgb "black" title "a = 2.25 in", \
     for [path in files("martin_moyce_*.csv")] path every ::1 with lines lw 2 title "a/d = ".part(path, 3)

set title "Tank at rest, ".deep.": pressure"
set xlabel "depth, m"
set ylabel "pressure, kPa"
set autoscale
plot out."tank_".deep.".csv" every ::1 using 1:($2/1e3) with points pt 7 ps 0.4 lc rgb "#2b6cb0" title "multipliers", \
     "" every ::1 using 1:($3/1e3) with lines lw 2 lc rgb "#dd6b20" title "rho g depth"

set title "Tank at rest, ".deep.": kinetic energy"
set xlabel "time, s"
set ylabel "J"
set logscale y
set format y "10^{%L}"
set key top right
plot out."tank_".deep."_steps.csv" every ::1 using 1:2 with lines lc rgb "#2b6cb0" notitle
unset logscale y
set format y

set title "Sloshing from 0.4 m/s: centre of mass, viscosity 0.02"
set xlabel "time, s"
set ylabel "mm from the middle"
plot for [path in files("sloshing_0.4_*_0.02.csv")] path every ::1 using 1:($2*1e3) with lines lw 2 \
     title sprintf("h = %g ms", 1e3 * real(part(path, 3)))
unset multiplot
