# plot_case.gp - cases against time: panels one under the other with columns of $track1 ... as lines, and with
# ramps, what they aim at or their limits: start + rate*time until an end.
left = 104
width = wide(700, 1, left + legend_room)
heading_height = 24
panel_top(p) = top + (p - 1)*(height + heading_height) + heading_height

eval column_page
height = high(height, panels, top + panels*heading_height + 56)
page_height = panel_top(panels + 1) - heading_height + 56
load 'page.gp'
do for [p=1:panels] {
    set label cut(heading[p], (width + legend_room)/7.1) at screen X(left), Y(panel_top(p) - 9) left @small front
    eval y_label(end_of(label[p], (height + heading_height)/6.9), 22, panel_top(p) + 0.5*height)
}
set label 'time (s)' at screen X(left + 0.5*width), Y(panel_top(panels) + height + 42) center font ',12' front
legend_x = left + width + 14
legend_y = top + heading_height + 8
legend_step = 22
load 'panels.gp'

eval grid
ramp(k, time) = ramp_start[k] + ramp_rate[k]*(time < ramp_end[k] ? time : ramp_end[k])
if (ramps < 1) { ramp_panel[1] = 0; ramp_dash[1] = 1; ramp_colour[1] = 0 } # which is looked at all the same
do for [p=1:panels] {
    eval panel(left, panel_top(p), width, height)
    eval linear_tics('x', from, to, width/62, p == panels)
    eval panel_tics(low[p], high[p], height)
    plot for [k=1:ramps] p == ramp_panel[k] ? ramp(k, x) : NaN with lines dt ramp_dash[k] lw 1.5 lc rgb ramp_colour[k] notitle, \
        for [k=1:tracks] '$track'.track_case[k] using 1:(p == track_panel[k] ? track_factor[k]*column(track_column[k]) : NaN) \
            with lines dt track_dash[k] lw track_width[k] lc rgb track_colour[k] notitle
}
