#include <cstdio>
#include <cmath>
#include <cstdlib>
#include "core/base/random.h"
#include "core/hair/strand_geometry.h"
#include "core/volume/transmittance.h"
using namespace hairbake;
int main(){ Progress p; Random r(3);
 for(double wh: {0.02,0.1,0.3}) for(int n: {9,33,65}) { double sum=0,sum2=0; double mx=0; int c=0; for(int rep=0;rep<60;rep++){ HairModel m; double y=r.next(-1,1),ph=r.next(0,6.283185); double q=sqrt(1-y*y); Vec3d d(q*cos(ph),y,q*sin(ph));
  // strand of 64 voxels length at voxel_size 1, vertices every 64/(n-1)
  m.strand_begin={0,(uint32_t)n}; Vec3d o(r.next(),r.next(),r.next()); for(int i=0;i<n;i++) m.positions.push_back(Vec3f(o+d*(64.0*i/(n-1)))); 
  // two far single points to fix a box are not needed
  StrandSettings s; s.width=wh; auto g=make_strand_geometry(m,s); TransmittanceSettings t; t.voxel_size=1; auto a=bake_transmittance_volume(g,t,p).average; for(int i=n/4;i<3*n/4;i++){ double v=-log(a[i])/wh; sum+=v; sum2+=v*v; mx=std::max(mx,1-(double)a[i]); c++; } }
 printf("w/h %.2f n %d: mean %.4f sd %.4f  max 1-A %.4f\n",wh,n,sum/c,sqrt(sum2/c-sum/c*sum/c),mx); } }
