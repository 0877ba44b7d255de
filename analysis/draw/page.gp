# page.gp - begins a page of page_width x page_height px with title and subtitle; labels and objects of
# the whole page may follow, then panels.gp. A PNG has 1.6 pixels for each px.
if (drawing eq 'svg') {
    set terminal svg size page_width,page_height font 'DejaVu Sans,12' background '#ffffff' noenhanced
} else {
    set terminal pngcairo size int(1.6*page_width),int(1.6*page_height) font 'DejaVu Sans,12' fontscale 1.6 \
        linewidth 1.6 pointscale 1.6 background '#ffffff' noenhanced
}
set output 'picture.'.drawing
set multiplot
set datafile missing 'NaN'
unset key
set label title_text(title, title_size) at screen X(margin), Y(margin + 0.6*title_size) left font ',15' front
set label title_text(subtitle, text_size) at screen X(margin), \
    Y(margin + lines_height(title_text(title, title_size), title_size) + 2 + 0.6*text_size) \
    left font ',12' textcolor '#505050' front
