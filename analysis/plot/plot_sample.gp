# plot_sample.gp - the points of a sample over the paths x and y, and under them the share of good ends
# against each path x1, x2 ...
left = 96
width = 520
height = 380
panel_width = 200
panel_height = 150
panel_left(p) = left - 20 + (p - 1) % 3*270
panel_top(p) = top + height + 100 + (p - 1)/3*232

page_width = left + width + 220
top = title_height(0)
page_height = panel_top(1) + (panels + 2)/3*232
load 'page.gp'
set label axis_label('x', width + 60) at screen X(left + 0.5*width), Y(top + height + 46) center @small front
if (plane) { set label axis_label('y', height) at screen X(22), Y(top + 0.5*height) center rotate by 90 @small front }
set label judged.' (%), bars: 95 % interval' at screen X(left - 80), Y(panel_top(1) - 18) left @small front
do for [p=1:panels] {
    set label value('x'.p.'_path') at screen X(panel_left(p) + 0.5*panel_width), Y(panel_top(p) + panel_height + 42) \
        center @tiny front
}
legend_x = left + width + 20
legend_y = top + 10
load 'panels.gp'

eval panel(left, top, width, height)
eval axis_tics('x', 7, 1)
if (plane) { eval axis_tics('y', 7, 1) } else { set yrange [0:1]; set ytics () }
size = points > 4000 ? 0.25 : points > 400 ? 0.45 : 0.8
if (shares) {
    eval palette
    set cbrange [0:100]
    set cbtics 20 nomirror out scale 0
    set cblabel judged.' (%)' offset 0.5,0
    eval colour_bar(legend_x, top + 40, 18, 180)
    plot $scatter using 1:2:3 with points pt 7 ps size lc palette notitle
    unset colorbox
} else {
    plot $scatter using 1:2:(kind_colour[$3+1]) with points pt 7 ps size lc rgb variable notitle
}
eval grid
do for [p=1:panels] {
    eval panel(panel_left(p), panel_top(p), panel_width, panel_height)
    eval axis_tics('x'.p, 4, 1)
    tic_font = value('x'.p.'_wordy') ? ',8' : ',12' # words are long, panels are not
    set xtics font tic_font
    eval panel_tics(0, most, panel_height)
    plot '$bins'.p using 1:2:3:4 with yerrorbars lc rgb judged_colour pt 7 ps 0.6 lw 1.4 notitle
}
