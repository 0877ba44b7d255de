# chart.gp - a chart: panels over the axis x one under the other, each with an axis y of its own, or a strip without
# one, which has its name beside it. Their series are drawn in the order in which the data have them.
between = headed ? 24 : 14
foot = headed ? 56 : 84
width = wide(chart_width, 1, left + legend_room)
eval chart_fit
own_sum = sum [p=1:panels] panel_own[p]

eval column_page
top = top + (headed ? 24 : 0)
stretch = asked_height > 0 ? at_least(50.0*panels, asked_height - legend_height - top - (panels - 1)*between - foot)/own_sum : 1.0
bottom = top
do for [p=1:panels] {
    panel_top[p] = bottom
    panel_high[p] = stretch*panel_own[p]
    bottom = bottom + panel_high[p] + (p < panels ? between : 0)
}
page_height = bottom + foot
load 'page.gp'
do for [p=1:panels] {
    if (headed) { set label cut(panel_heading[p], (width + legend_room)/7.1) at screen X(left), Y(panel_top[p] - 9) left @small front }
    middle = panel_top[p] + 0.5*panel_high[p]
    if (panel_y[p] eq '') { set label chart_beside at screen X(left - 10), Y(middle) right font ',12' front } \
    else { eval y_label(axis_label(panel_y[p], panel_high[p] + between), 24, middle) }
}
eval x_label(left + 0.5*width, bottom + (headed ? 42 : 46))
eval column_legend
load 'panels.gp'

do for [p=1:panels] {
    eval panel(left, panel_top[p], width, panel_high[p])
    eval axis_tics('x', width/62, p == panels)
    if (panel_y[p] eq '') {
        unset grid
        set yrange [0:1]
        set ytics (-1) # none in sight
    } else {
        eval grid
        eval axis_tics(panel_y[p], panel_high[p] < 160 ? 4 : int(panel_high[p]/36), 1)
    }
    eval 'plot '.panel_plot[p][3:*]
}
