# plot_accuracy.gp - error against cost, for each method $errors<method>_<panel>: cost, error, whether it is more
# than none, cases given up.
left = 108
gap = 108
width = wide(400, panels, left + (panels - 1)*gap + legend_room)
panel_left(p) = left + (p - 1)*(width + gap)
array what[2] = ['largest error of a coordinate (m, rad)', 'mean over time of the velocity error (m/s, rad/s)']
array marker[5] = [7, 5, 9, 11, 13] # filled; one less is the open one

page_width = panel_left(panels) + width + legend_room
top = title_height(0)
height = high(380, 1, top + 78)
page_height = top + height + 78
load 'page.gp'
legend_x = panel_left(panels) + width + 20
legend_y = top + 10
load 'panels.gp'

eval grid
set xtics @tiny
set ytics @tiny
x_title = width < 380 ? 'cost: µs of one core per simulated s' : 'cost: microseconds of one core per simulated second'
set xlabel x_title @tiny
do for [p=1:panels] {
    eval panel(panel_left(p), top, width, height)
    y_title = labels ? 'share of cells unlike the reference' : what[p]
    set ylabel y_title @tiny
    set logscale xy
    eval log_tics('x', log10(0.6*cost_low[1]), log10(1.7*cost_high[1]), 6, 1, 1)
    eval log_tics('y', log10(0.6*error_low[p]), log10(1.7*error_high[p]), 10, 1, 1)
    errors(m) = sprintf('$errors%d_%d', m, p)
    plot NaN notitle, for [m=1:legends] errors(m) using 1:2 with lines lc rgb legend_colour[m] lw 1.6 notitle, \
        for [m=1:legends] errors(m) using 1:($3 > 0 ? NaN : $2) with points lc rgb legend_colour[m] \
            pt marker[method_style[m]]-1 ps 1 notitle, \
        for [m=1:legends] errors(m) using 1:($3 > 0 ? $2 : NaN) with points lc rgb legend_colour[m] \
            pt marker[method_style[m]] ps 0.9 notitle, \
        for [m=1:legends] errors(m) using 1:($4 > 0 ? $2 : NaN) with points lc rgb '#b00000' pt 2 ps 1.6 lw 1.6 notitle
    unset logscale
}
