# plot_shares.gp - shares of cases against the axis x, with their intervals or bounds: a band, of words bars;
# under it the extent of what was stabilised along each axis of offsets.
left = 104
width = wide(620, 1, left + legend_room)
gap = 14
share_type(k) = legend_point[k] > 0 ? legend_point[k] : 7
share_dash(k) = legend_dash[k] > 0 ? legend_dash[k] : 1
panel_top(p) = top + height + gap + (p - 1)*(low_height + gap)

eval column_page
# Of the height two parts are the first panel's, one each that of the others.
low_height = high(150, 2 + extents, top + gap*extents + 84)
height = 2*low_height
bottom = panel_top(extents + 1) - gap
page_height = bottom + 84
load 'page.gp'
eval y_label(cut(volumes ? 'share of the box of starts (%)' : 'share of the cases done (%)', height/6.9), 24, top + 0.5*height)
eval x_label(left + 0.5*width, bottom + 46)
eval column_legend
do for [p=1:extents] {
    eval y_label(end_of(with_unit(extent_name[p], extent_unit[p]), (low_height + gap)/6.9), 24, panel_top(p) + 0.5*low_height)
}
load 'panels.gp'

eval panel(left, top, width, height)
eval axis_tics('x', width/62, extents == 0)
eval panel_tics(0, most, height)
eval grid
if (words) {
    plot for [k=1:bounded*shares] '$share'.k using 1:2:5:6 with yerrorbars lc rgb legend_colour[k] pt 0 lw 0.8 notitle, \
        for [k=1:shares] '$share'.k using 1:2:3:4 with yerrorbars lc rgb legend_colour[k] pt share_type(k) ps 1.1 lw 2.4 notitle
} else {
    plot for [k=1:bounded*shares] '$share'.k using 1:5:6 with filledcurves lc rgb legend_colour[k] \
            fillstyle transparent solid 0.12 notitle, \
        for [k=1:shares] '$share'.k using 1:3:4 with filledcurves lc rgb legend_colour[k] \
            fillstyle transparent solid 0.35 notitle, \
        for [k=1:shares] '$share'.k using 1:2 with linespoints lc rgb legend_colour[k] lw 2 dt share_dash(k) pt share_type(k) ps 0.8 notitle
}
set arrow 1 from graph 0, first 0 to graph 1, first 0 nohead dt 2 lc rgb '#909090'
do for [p=1:extents] {
    eval panel(left, panel_top(p), width, low_height)
    eval axis_tics('x', width/62, p == extents)
    eval panel_tics(extent_low[p], extent_high[p], low_height)
    if (words) {
        plot '$extent'.p using 1:2:($1-0.05):($1+0.05):2:3 with boxxyerror lc rgb hue[1] fillstyle solid noborder notitle
    } else {
        plot '$extent'.p using 1:2:3 with filledcurves lc rgb hue[1] fillstyle transparent solid 0.22 notitle, \
            for [k=2:3] '$extent'.p using 1:k with linespoints lc rgb hue[1] lw 1.6 pt 7 ps 0.5 notitle
    }
}
