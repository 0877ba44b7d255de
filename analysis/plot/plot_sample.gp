# plot_sample.gp - the points of a sample over the paths x and y, and under them the share of good ends
# against each path x1, x2 ...
left = 104
width = wide(520, 1, left + legend_room)
columns = asked_width > 0 ? int(at_least(1, (asked_width - 36)/230)) : 3
panel_width = wide(200, columns, left - 20 + (columns - 1)*70 + margin)
panel_height = 0.75*panel_width
panel_left(p) = left - 20 + (p - 1) % columns*(panel_width + 70)
panel_top(p) = top + height + 100 + (p - 1)/columns*(panel_height + 82)
rows = (panels + columns - 1)/columns

page_width = at_least(left + width + legend_room, panel_left(columns) + panel_width + margin)
top = title_height(0)
height = high(380.0*width/520, 1, top + 100 + rows*(panel_height + 82))
page_height = panel_top(1) + rows*(panel_height + 82)
load 'page.gp'
eval x_label(left + 0.5*width, top + height + 46)
if (plane) { eval y_label(axis_label('y', height), 22, top + 0.5*height) }
set label judged.' (%), bars: 95 % interval' at screen X(left - 80), Y(panel_top(1) - 18) left @small front
do for [p=1:panels] {
    set label end_of(value('x'.p.'_path'), (panel_width + 40)/6.9) at screen X(panel_left(p) + 0.5*panel_width), Y(panel_top(p) + panel_height + 42) \
        center @tiny front
}
eval column_legend
load 'panels.gp'

eval panel(left, top, width, height)
eval axis_tics('x', width/72, 1)
if (plane) { eval axis_tics('y', 7, 1) } else { set yrange [0:1]; set ytics () }
size = points > 4000 ? 0.25 : points > 400 ? 0.45 : 0.8
if (shares) {
    eval palette
    set cbrange [0:100]
    set cbtics 20 nomirror out scale 0
    set cblabel judged.' (%)' offset 0.5,0
    eval legend_bar(0)
    plot $scatter using 1:2:3 with points pt 7 ps size lc palette notitle
    unset colorbox
} else {
    plot $scatter using 1:2:(kind_colour[$3+1]) with points pt 7 ps size lc rgb variable notitle
}
eval grid
do for [p=1:panels] {
    eval panel(panel_left(p), panel_top(p), panel_width, panel_height)
    eval axis_tics('x'.p, panel_width/50, 1)
    tic_font = value('x'.p.'_wordy') ? ',8' : ',12' # words are long, panels are not
    set xtics font tic_font
    eval panel_tics(0, most, panel_height)
    plot '$bins'.p using 1:2:3:4 with yerrorbars lc rgb judged_colour pt 7 ps 0.6 lw 1.4 notitle
}
