# plot_line.gp - every case of a line: a strip of outcomes, and a panel for each answer against the axis x,
# its points in the colours of the outcomes.
left = 104
width = wide(620, 1, left + legend_room)
strip = 30
gap = 14
panel_top(p) = top + strip + gap + (p - 1)*(height + gap)

eval column_page
height = high(150, at_least(panels, 1), top + strip + panels*gap + 84)
bottom = panel_top(panels + 1) - gap
page_height = bottom + 84
load 'page.gp'
set label 'outcome' at screen X(left - 10), Y(top + 0.5*strip) right font ',12' front
do for [p=1:panels] {
    eval y_label(end_of(with_unit(answer[p], answer_unit[p]), (height + gap)/6.9), 24, panel_top(p) + 0.5*height)
}
eval x_label(left + 0.5*width, bottom + 46)
eval column_legend
load 'panels.gp'

eval panel(left, top, width, strip)
eval axis_tics('x', width/62, panels == 0)
set yrange [0:1]
set ytics (-1) # none in sight
plot $runs using (0.5*($1+$2)):(0.5):1:2:(0):(1):(kind_colour[$3+1]) \
    with boxxyerror fillstyle solid noborder lc rgb variable notitle
eval grid
size = x_count > 400 ? 0.25 : x_count > 100 ? 0.45 : 0.8
do for [p=1:panels] {
    # Points are not to sit on the frame.
    room = highest[p] > lowest[p] ? 0.06*(highest[p] - lowest[p]) : 0.1*abs(lowest[p]) + 0.05
    eval panel(left, panel_top(p), width, height)
    eval axis_tics('x', width/62, p == panels)
    eval panel_tics(lowest[p] - room, highest[p] + room, height)
    plot '$line'.p using 1:2 with lines lc rgb '#b0b0b0' lw 1 notitle, \
        '$line'.p using 1:2:(kind_colour[$3+1]) with points pt 7 ps size lc rgb variable notitle
}
