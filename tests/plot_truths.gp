# plot_truths.gp - a line of the picture for each of rows: its name, its error bar ($bars: bar, row) in grey, and the
# error of each of methods ($errors<method>: error, row, whether there is none).
left = 290
line_height = 17
width = wide(560, 1, left + legend_room + 10)
page_width = left + width + legend_room + 10
top = title_height(0)
height = high(at_least(line_height*rows + 12, 110), 1, top + 60)
page_height = top + height + 60
load 'page.gp'
do for [k=1:rows] {
    set label name[k] at screen X(left - 8), Y(top + height*(k - 0.4)/(rows + 0.2)) right @tiny front
}
legend_x = left + width + 20
legend_y = top + 10
load 'panels.gp'

array marker[7] = [7, 5, 9, 11, 13, 15, 2]
eval grid
eval panel(left, top, width, height)
set xtics @tiny
unset ytics
set xlabel 'error, in the unit of what is read' @tiny
set logscale x
set format x '%.0e'
set xtics 1e-16, 1e3, 100
set mxtics 1
set xrange [4e-17:1e3]
set yrange [rows + 0.6:0.4]
plot '$bars' using (4e-17):2:(4e-17):1:($2 - 0.5):($2 + 0.5) with boxxy fs solid noborder lc rgb '#dedede' notitle, \
    for [m=1:methods] sprintf('$errors%d', m) using 1:($2 + 0.1*(m - 0.5*(methods + 1))) with points lc rgb hue[m] pt marker[m] ps 0.8 notitle, \
    for [m=1:methods] sprintf('$errors%d', m) using ($3 > 0 ? 500 : NaN):($2 + 0.1*(m - 0.5*(methods + 1))) with points lc rgb hue[m] pt 2 ps 0.7 lw 1.4 notitle
