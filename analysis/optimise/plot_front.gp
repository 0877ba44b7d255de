# plot_front.gp - shares of the starts that searches reach, against the axis x.
left = 88
width = wide(480, 1, left + legend_room)
page_width = left + width + legend_room
top = title_height(0) + 4
height = high(0.7*width, 1, top + 84)
page_height = top + height + 84
load 'page.gp'
eval y_label('recovered starts (%)', 22, top + 0.5*height)
eval x_label(left + 0.5*width, top + height + 46)
eval column_legend
load 'panels.gp'

eval grid
eval panel(left, top, width, height)
eval axis_tics('x', width/65, 1)
eval panel_tics(0, most, height)
if (limited) { plot $front using 1:8 with linespoints lc rgb curve_colour(3) dt curve_dash(3) lw 2 pt 9 ps 0.8 notitle }
plot for [k=2:1:-1] $front using 1:3*k-1 with lines lc rgb curve_colour(k) dt curve_dash(k) lw 2 notitle, \
    for [k=2:1:-1] $front using 1:3*k-1:3*k:3*k+1 with yerrorbars lc rgb curve_colour(k) pt (k == 1 ? 5 : 7) ps 0.7 lw 1.4 notitle
