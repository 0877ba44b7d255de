# plot_model.gp - the robot in one posture: $segments its stick figure, the ground z = -fall x, $zeros where angles are 0,
# $arrows (x, y, dx, dy, ink, whether it has a head) and labels of coordinates, actuators and contacts. Both
# directions have the same scale.
page_width = 1060
words_left = 600
words_width = page_width - words_left - margin
array ink[3] = [0x0072b2, 0xd55e00, 0x009e73]
top = title_height(0)
words_height = 0
beside(i) = wrap(word_text[i], letters(words_width - 24, 10.5))
do for [i=1:words_shown] { words_height = words_height + 9 + 16*lines(beside(i)) }
side = 1.0*(words_left - 2*margin)
room = 0.28*size
height = side*(high_y - low_y + 2*room)/(high_x - low_x + 2*room)
height = height < 300 ? 300 : height > 620 ? 620 : height
page_height = int(top + 20 + (height > words_height + 170 ? height : words_height + 170))
load 'page.gp'

line = top + 18
do for [i=1:words_shown] {
    set object rectangle from screen X(words_left), Y(line + 5) to screen X(words_left + 10), Y(line - 5) \
        fillcolor rgb ink[word_ink[i]+1] fillstyle solid border lc '#606060' lw 0.5 front
    set label beside(i) at screen X(words_left + 20), Y(line) left font ',11' front
    line = line + 9 + 16*lines(beside(i))
}
# Which way is positive.
line = line + 66
set arrow from screen X(words_left + 10), Y(line) to screen X(words_left + 60), Y(line) head filled size screen 0.010,20 lw 1.6 lc rgb '#303030'
set arrow from screen X(words_left + 10), Y(line) to screen X(words_left + 10), Y(line - 50) head filled size screen 0.010,20 lw 1.6 lc rgb '#303030'
set label 'x, forward' at screen X(words_left + 66), Y(line) left font ',11' front
set label 'z, up' at screen X(words_left + 16), Y(line - 52) left font ',11' front
set label "angles and torques: counter-clockwise\ndashed: where an angle is 0" \
    at screen X(words_left), Y(line + 24) left font ',11' front
legend_x = 0
legend_y = 0
load 'panels.gp'

unset border
unset xtics
unset ytics
eval panel(margin, top + 6, side, height)
scale = side/(high_x - low_x + 2*room)
scale = scale < height/(high_y - low_y + 2*room) ? scale : height/(high_y - low_y + 2*room)
middle_x = 0.5*(low_x + high_x)
middle_y = 0.5*(low_y + high_y)
set xrange [middle_x - 0.5*side/scale:middle_x + 0.5*side/scale]
set yrange [middle_y - 0.5*height/scale:middle_y + 0.5*height/scale]
set style textbox opaque noborder margins 0.4,0.2
do for [i=1:labels] {
    set label label_text[i] at label_x[i], label_y[i] center font ',13' textcolor rgb ink[label_ink[i]+1] boxed front
}
if (has_place) {
    set label '(x, z)' at place_x, place_y left offset char 1.2,0.9 font ',13' textcolor rgb ink[1] boxed front
}
bottom = middle_y - 0.5*height/scale
ground(x) = -fall*x > bottom ? -fall*x : bottom
plot '+' using 1:(ground($1)) with filledcurves y1=bottom fc rgb '#f0f0f0' notitle, \
    '+' using 1:(-fall*$1) with lines lw 2 lc rgb '#a0a0a0' notitle, \
    $segments using 1:2 with lines lw 3.4 lc rgb '#303030' notitle, \
    $zeros using 1:2 with lines dt 2 lw 1.2 lc rgb '#606060' notitle, \
    $segments using 1:2 with points pt 7 ps 0.7 lc rgb '#303030' notitle, \
    for [k=0:2] $arrows using 1:($5 == k && $6 == 0 ? $2 : NaN):3:4 with vectors nohead lw 2 lc rgb ink[k+1] notitle, \
    for [k=0:2] $arrows using 1:($5 == k && $6 == 1 ? $2 : NaN):3:4 with vectors head filled size screen 0.011,22 fixed \
        lw 2 lc rgb ink[k+1] notitle, \
    '+' using (has_place ? place_x : NaN):(place_y) every ::0::0 with points pt 6 ps 2 lw 2 lc rgb ink[1] notitle
