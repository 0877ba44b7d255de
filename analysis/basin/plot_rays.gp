# plot_rays.gp - how far from the equilibrium an outcome reaches: in the plane of two coordinates, or the share
# of directions that have ended by each scale.
left = 104
width = wide(520, 1, left + legend_room)

eval column_page
height = high(440.0*width/520, 1, top + 84)
page_height = top + height + 84
load 'page.gp'
eval x_label(left + 0.5*width, top + height + 46)
eval y_label(plane ? axis_label('y', height) : 'directions that have ended (%)', plane ? 16 : 24, top + 0.5*height)
eval column_legend
load 'panels.gp'

eval panel(left, top, width, height)
eval grid
if (plane) {
    eval linear_tics('x', -x_most, x_most, width/72, 1)
    eval linear_tics('y', -y_most, y_most, 8, 1)
    set label '' at 0,0 point pt 1 ps 1.6 lw 2 lc rgb 'black' front
    plot for [k=1:curves] '$curve'.k using 1:2 with lines lw 1.6 lc rgb hue[k] notitle, \
        for [k=1:curves] '$curve'.k using 1:2 every (curves > 1 ? 8 : 1) with points pt (curves > 1 ? legend_point[k] : 7) \
            ps (curves > 1 ? 0.9 : 0.3) lc rgb hue[k] notitle, \
        for [k=1:curves] '$open'.k using 1:2 with points pt 6 ps 0.7 lc rgb hue[k] notitle, \
        for [k=1:curves] '$first'.k using 1:2 with lines lw 1.6 dt 2 lc rgb hue[k] notitle, \
        for [k=1:curves] '$nearest'.k using 1:2 with points pt 13 ps 1.8 lc rgb 'black' notitle, \
        for [k=1:curves] '$nearest'.k using 1:2 with points pt 13 ps 1.2 lc rgb hue[k] notitle
} else {
    set xrange [0:*]
    set xtics autofreq
    eval linear_tics('y', 0, 100, 5, 1)
    plot for [k=1:curves] '$curve'.k using 1:2 with steps lw 1.8 lc rgb hue[k] notitle, \
        for [k=1:(curves > 1 ? curves : 0)] '$curve'.k using 1:2 every 40::12*k with points pt legend_point[k] ps 0.9 lc rgb hue[k] notitle, \
        for [k=1:curves] '$nearest'.k using 1:2 with points pt 13 ps 1.8 lc rgb 'black' notitle, \
        for [k=1:curves] '$nearest'.k using 1:2 with points pt 13 ps 1.2 lc rgb hue[k] notitle
}
