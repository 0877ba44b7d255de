# robustness.gp - what robustness.py has found, `folder` with its tables, `style` with style.gp, `said` about correlations:
# the largest push by phase, and of gaits whose numbers are drawn two predictors against how much rough ground they walk.
load style
set terminal pngcairo size 1500,560 font 'DejaVu Sans,12' background '#ffffff' noenhanced
set output folder.'/robustness.png'
set datafile separator ','
set datafile missing ''
set multiplot
set border 3 lw 0.8 lc '#404040'
set tics nomirror out scale 0.6 textcolor '#202020'
eval grid
names = 'P1 P3 RABBIT'
array mass[3] = [10.8, 10.8, 40]
array shape[3] = [7, 5, 9]
robots = folder.'/robustness.csv'
gaits = folder.'/robust_gaits.csv'
push(way, k) = sprintf("< awk -F, '$1 == \"%s\" && $2 ~ /^push %s/ {split($2, at, \" \"); print at[4] + 0 \",\" $4 / %g}' %s", \
    word(names, k), way, mass[k], robots)

set lmargin at screen 0.055; set rmargin at screen 0.305; set tmargin at screen 0.83; set bmargin at screen 0.13
set label 1 'Largest push of 0.1 s at the hip' at screen 0.055,0.94 left font ',14'
set label 2 'forwards above, backwards below, by when in the step it begins' at screen 0.055,0.89 left font ',11' textcolor '#505050'
set xlabel 'part of the step gone by'
set ylabel 'impulse by mass (m/s)' offset 1
set xrange [-0.05:0.8]
set xtics 0.25
set xzeroaxis lt 1 lc rgb '#404040' lw 0.8
set key at graph 0.03,0.99 left top Left reverse samplen 1.5
plot for [k=1:3] push('forwards', k) using ($1/4):2 with linespoints pt shape[k] ps 1.4 lw 2 lc rgb hue[k] title word(names, k), \
     for [k=1:3] push('backwards', k) using ($1/4):(-$2) with linespoints pt shape[k] ps 1.4 lw 2 lc rgb hue[k] notitle

unset xzeroaxis
set xtics autofreq
set ylabel 'part of rough grounds that are walked' offset 1
set yrange [-0.03:1.03]
of(k, column) = sprintf("< awk -F, -v name=%s 'NR == 1 {for (i = 1; i <= NF; i++) at[$i] = i} $1 == name {print $at[\"%s\"] \",\" $at[\"rough\"]}' %s", \
    word(names, k), column, gaits)
array column[2] = ['norm_period', 'multiplier']
array title[2] = ['Gaits drawn at random: the sensitivity norm', '... and the largest multiplier']
array x[2] = ['deviation of the step time by that of the ground (ms/mm)', 'modulus of the largest multiplier']
do for [p=1:2] {
    first = 0.385 + 0.325*(p - 1)
    set lmargin at screen first; set rmargin at screen first + 0.255
    set label 1 title[p] at screen first,0.94
    set label 2 "Spearman's rank correlation with it, 95 % interval" at screen first,0.89
    set xlabel x[p]
    if (p == 1) { set logscale x; set xrange [*:*] } else { unset logscale x; set xrange [0:1] }
    set key at graph 1.06,1.0 right top Left reverse samplen 0.5 opaque
    plot for [k=1:3] of(k, column[p]) using 1:2 with points pt shape[k] ps 1.1 lc rgb hue[k] title word(said[p], k)
}
