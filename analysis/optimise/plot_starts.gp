# plot_starts.gp - shares of the starts along each of their coordinates, a panel each.
left = 88
gap = 32
columns = at_most(panels, asked_width > 0 ? int(at_least(1, (asked_width - 80)/180)) : 3)
width = wide(210, columns, left + legend_room + (columns - 1)*gap)
rows = (panels + columns - 1)/columns
page_width = at_least(left + columns*width + (columns - 1)*gap + legend_room, 420)
top = title_height(0) + 6
height = high(0.8*width, rows, top + rows*66)
panel_left(p) = left + (p - 1) % columns*(width + gap)
panel_top(p) = top + (p - 1)/columns*(height + 66)
page_height = panel_top(panels) + height + 66
load 'page.gp'
eval y_label('share of the starts (%)', 24, top + 0.5*((rows - 1)*(height + 66) + height))
do for [p=1:panels] {
    set label cut(panel_text[p], (width + gap)/6.6) at screen X(panel_left(p) + 0.5*width), Y(panel_top(p) + height + 40) center @small front
}
legend_x = left + columns*width + (columns - 1)*gap + 20
legend_y = top + 10
load 'panels.gp'

eval grid
do for [p=1:panels] {
    eval panel(panel_left(p), panel_top(p), width, height)
    eval linear_tics('x', panel_low[p], panel_high[p], width/56, 1)
    eval linear_tics('y', 0, most, height < 160 ? 4 : int(height/36), (p - 1) % columns == 0)
    plot for [k=2+limited:1:-1] '$parts'.p using 1:3*k-1 with lines lc rgb curve_colour(k) dt curve_dash(k) lw 2 notitle, \
        for [k=2+limited:1:-1] '$parts'.p using 1:3*k-1:3*k:3*k+1 with yerrorbars lc rgb curve_colour(k) pt 7 ps 0.4 lw 1.2 notitle
}
