# plot_peers.gp - error against cost, for each method, and each peer (peer[m]: 1 all its settings, 2 its defaults),
# $errors<series>_<panel>: cost, error, whether it is more than none, cases given up; and what a line joins,
# $line<series>_<panel>. As plot_accuracy.c draws them.
left = 108
gap = 108
legend = 300
width = wide(400, panels, left + (panels - 1)*gap + legend)
panel_left(p) = left + (p - 1)*(width + gap)
array what[2] = ['largest error of a coordinate (m, rad)', 'mean over time of the velocity error (m/s, rad/s)']
array marker[7] = [7, 5, 9, 11, 13, 15, 2] # filled; one less is the open one

page_width = panel_left(panels) + width + legend
top = title_height(0)
height = high(380, 1, top + 78)
page_height = top + height + 78
load 'page.gp'
do for [m=1:series] {
    line = top + 10 + 53*(m - 1)
    eval box(page_width - legend + 24, line, hue[style[m]])
    set label series_name[m] at screen X(page_width - legend + 46), Y(line) left font ',12' front
    do for [k=1:2] {
        set label about[2*(m - 1) + k] at screen X(page_width - legend + 46), Y(line + 3 + 14*k) left font ',9' front
    }
}
legend_x = 0
legend_y = 0
load 'panels.gp'

eval grid
set xtics @tiny
set ytics @tiny
set xlabel 'cost: microseconds of one core per simulated second' @tiny
errors(m) = sprintf('$errors%d_%d', m, p)
joined(m) = sprintf('$line%d_%d', m, p)
dash(m) = peer[m] == 2 ? 3 : 1
do for [p=1:panels] {
    eval panel(panel_left(p), top, width, height)
    y_title = labels ? 'share of cells unlike the reference' : what[p]
    set ylabel y_title @tiny
    set logscale xy
    eval log_tics('x', log10(0.6*cost_low), log10(1.7*cost_high), 6, 1, 1)
    eval log_tics('y', log10(0.6*error_low[p]), log10(1.7*error_high[p]), 10, 1, 1)
    plot NaN notitle, for [m=1:series] joined(m) using 1:2 with lines lc rgb hue[style[m]] lw (peer[m] ? 2.2 : 1.6) \
            dt dash(m) notitle, \
        for [m=1:series] errors(m) using 1:($3 > 0 ? NaN : $2) with points lc rgb hue[style[m]] \
            pt marker[style[m]]-1 ps (peer[m] == 1 ? 0.7 : 1) notitle, \
        for [m=1:series] errors(m) using 1:($3 > 0 ? $2 : NaN) with points lc rgb hue[style[m]] \
            pt marker[style[m]] ps (peer[m] == 1 ? 0.5 : 0.9) notitle, \
        for [m=1:series] errors(m) using 1:($4 > 0 ? $2 : NaN) with points lc rgb '#b00000' pt 2 ps 1.6 lw 1.6 notitle
    unset logscale
}
